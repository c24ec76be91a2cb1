#pragma once
// OpenMesh's readers fill this instead of a halfedge mesh, which would refuse or repair what is not manifold.

#include "surface/mesh.h"

#include <OpenMesh/Core/IO/importer/BaseImporter.hh>

#include <string>
#include <utility>
#include <vector>

namespace patina {

/// Collects vertices, faces, UVs, colours and custom vertex properties as they come. Normals, edges, materials and
/// face attributes are ignored.
class FaceListImporter : public OpenMesh::IO::BaseImporter {
  public:
    /// Custom properties of PLY are stored by the reader in a kernel, which has to know its size beforehand.
    FaceListImporter(std::size_t vertexCount, std::size_t faceCount) : properties_(vertexCount, faceCount) {}

    /// Creases and sharp corners, which OpenMesh's readers do not know; vertices in the order of add_vertex().
    void setSharp(std::vector<Crease> creases, std::vector<SharpCorner> corners) {
        mesh_.creases = std::move(creases);
        mesh_.corners = std::move(corners);
    }

    /// What was read. UVs only where every corner has one; attributes only where every referenced vertex has one.
    Mesh takeMesh();

    OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& position) override;
    OpenMesh::VertexHandle add_vertex() override;
    OpenMesh::FaceHandle add_face(const VHandles& corners) override;
    void add_face_texcoords(OpenMesh::FaceHandle face, OpenMesh::VertexHandle first,
                            const std::vector<OpenMesh::Vec2f>& uvs) override;
    void set_point(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& position) override;
    void set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3uc& colour) override;
    void set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec4uc& colour) override;
    void set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& colour) override;
    void set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec4f& colour) override;
    void set_texcoord(OpenMesh::VertexHandle vertex, const OpenMesh::Vec2f& uv) override;
    OpenMesh::BaseKernel* kernel() override { return &properties_; }
    void reserve(unsigned int vertices, unsigned int edges, unsigned int faces) override;
    size_t n_vertices() const override { return mesh_.positions.size(); }
    size_t n_faces() const override { return mesh_.faceSizes.size(); }
    size_t n_edges() const override { return 0; }

    OpenMesh::HalfedgeHandle add_edge(OpenMesh::VertexHandle, OpenMesh::VertexHandle) override {
        return OpenMesh::HalfedgeHandle();
    }
    OpenMesh::FaceHandle add_face(OpenMesh::HalfedgeHandle) override { return OpenMesh::FaceHandle(); }
    void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle,
                            const std::vector<OpenMesh::Vec3f>&) override {}
    void set_face_texindex(OpenMesh::FaceHandle, int) override {}
    void set_halfedge(OpenMesh::VertexHandle, OpenMesh::HalfedgeHandle) override {}
    void set_normal(OpenMesh::VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(OpenMesh::VertexHandle, const OpenMesh::Vec3d&) override {}
    void set_status(OpenMesh::VertexHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_next(OpenMesh::HalfedgeHandle, OpenMesh::HalfedgeHandle) override {}
    void set_face(OpenMesh::HalfedgeHandle, OpenMesh::FaceHandle) override {}
    void request_face_texcoords2D() override {}
    void set_texcoord(OpenMesh::HalfedgeHandle, const OpenMesh::Vec2f&) override {}
    void set_texcoord(OpenMesh::VertexHandle, const OpenMesh::Vec3f&) override {}
    void set_texcoord(OpenMesh::HalfedgeHandle, const OpenMesh::Vec3f&) override {}
    void set_status(OpenMesh::HalfedgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::EdgeHandle, const OpenMesh::Vec4f&) override {}
    void set_status(OpenMesh::EdgeHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void set_normal(OpenMesh::FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_normal(OpenMesh::FaceHandle, const OpenMesh::Vec3d&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec3uc&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec4uc&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec3f&) override {}
    void set_color(OpenMesh::FaceHandle, const OpenMesh::Vec4f&) override {}
    void set_status(OpenMesh::FaceHandle, const OpenMesh::Attributes::StatusInfo&) override {}
    void add_texture_information(int, std::string) override {}

  private:
    /// The properties of a mesh without the mesh.
    class Properties : public OpenMesh::BaseKernel {
      public:
        Properties(std::size_t vertices, std::size_t faces) : vertices_(vertices), faces_(faces) {}
        size_t n_vertices() const override { return vertices_; }
        size_t n_faces() const override { return faces_; }

      private:
        std::size_t vertices_;
        std::size_t faces_;
    };

    void takeUvs();
    void takeCustomProperties();
    void dropUnreferenced();
    void dropIncompleteAttributes();

    Mesh mesh_;
    Properties properties_;
    std::vector<std::size_t> faceStarts_;
    std::vector<Imath::V3f> colours_; ///< NaN where a vertex has none; empty where no vertex has one
    std::vector<Imath::V2f> vertexUvs_;
    std::vector<Imath::V2f> cornerUvs_; ///< parallel to the corners; NaN where a corner has none
};

} // namespace patina
