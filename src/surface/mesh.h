#pragma once
// A polygon mesh as a plain face list: whatever a file holds, also what no halfedge structure can.

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

#include <map>
#include <string>
#include <vector>

namespace patina {

/// An edge that subdivision keeps sharp, as OpenSubdiv and USD have it: 0 smooth, 10 and more for ever, between so many
/// levels long.
struct Crease {
    int a = 0, b = 0; ///< the edge's vertices
    float sharpness = 0.f;
};

/// A vertex that subdivision keeps sharp.
struct SharpCorner {
    int vertex = 0;
    float sharpness = 0.f;
};

/// Polygons of any size over shared vertices. Face f's corners are
/// `faceVertices[faceStart(f) … + faceSizes[f])`; UVs, where there are any, have an index per corner.
struct Mesh {
    std::string name;                  ///< the file's stem or the shape's name; names the outputs
    std::vector<Imath::V3f> positions; ///< scene units
    std::vector<int> faceSizes;        ///< corners of each face, 3 or more
    std::vector<int> faceVertices;     ///< concatenated corners, counter-clockwise from outside
    std::vector<Imath::V2f> uvs;
    std::vector<int> faceUvs; ///< parallel to faceVertices, or empty where the mesh has no UVs
    std::map<std::string, std::vector<float>> vertexAttributes; ///< one float per vertex
    std::vector<Crease> creases;                                ///< of edges of the faces
    std::vector<SharpCorner> corners;

    bool hasUvs() const { return !faceUvs.empty(); }
    std::size_t faceCount() const { return faceSizes.size(); }
    Imath::Box3f bounds() const;
};

/// The surface everything downstream sees (volume, bake, growth, pictures): the limit surface of a cage, or a scan
/// as it is, in triangles fine enough to stand for it.
struct SurfaceMesh {
    std::vector<Imath::V3f> positions; ///< on the limit surface, scene units
    std::vector<Imath::V3f> normals;   ///< unit, per vertex: the limit normals; for scans angle-weighted
    std::vector<Imath::V3i> triangles; ///< counter-clockwise from outside
    std::vector<Imath::V2f> uvs;
    std::vector<Imath::V3i> triangleUvs; ///< parallel to triangles, or empty
    std::vector<int> triangleFaces;      ///< the face of the control mesh each triangle came from
    std::map<std::string, std::vector<float>> vertexAttributes;
    bool closed = true; ///< every edge has two triangles
    std::string note;   ///< what the user should know about how it was made (a scheme that could not be used), or empty

    bool hasUvs() const { return !triangleUvs.empty(); }
    Imath::Box3f bounds() const;
    double area() const; ///< scene units squared
};

/// A point on a SurfaceMesh: triangle and the barycentric weights of its second and third corner.
struct SurfacePoint {
    int triangle = -1;
    float u = 0.f;
    float v = 0.f;
};

Imath::V3d positionAt(const SurfaceMesh& surface, const SurfacePoint& point);
Imath::V3d normalAt(const SurfaceMesh& surface, const SurfacePoint& point); ///< interpolated, unit
Imath::V2d uvAt(const SurfaceMesh& surface, const SurfacePoint& point);     ///< needs UVs

} // namespace patina
