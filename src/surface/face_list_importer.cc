#include "surface/face_list_importer.h"

#include "surface/weld.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

using Imath::V2f;
using Imath::V3f;

namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

/// A custom property of one number per vertex, whatever its type, as floats.
template <class... Types>
struct NumbersOf;
template <class Type, class... Rest>
struct NumbersOf<Type, Rest...> {
    static bool read(const OpenMesh::BaseProperty& property, std::vector<float>& values) {
        const auto* typed = dynamic_cast<const OpenMesh::PropertyT<Type>*>(&property);
        if (!typed)
            return NumbersOf<Rest...>::read(property, values);
        values.assign(typed->data(), typed->data() + typed->n_elements());
        return true;
    }
};
template <>
struct NumbersOf<> {
    static bool read(const OpenMesh::BaseProperty&, std::vector<float>&) { return false; }
};

/// A vertex counts once in a face; faces with fewer than three different ones go.
void dropRepeatedCorners(Mesh& mesh) {
    std::vector<std::size_t> seen(mesh.positions.size(), 0);
    std::size_t read = 0, written = 0, faces = 0;
    for (std::size_t face = 0; face < mesh.faceSizes.size(); ++face) {
        const std::size_t start = written;
        for (int i = 0; i < mesh.faceSizes[face]; ++i, ++read) {
            const int vertex = mesh.faceVertices[read];
            if (seen[vertex] == face + 1)
                continue;
            seen[vertex] = face + 1;
            mesh.faceVertices[written] = vertex;
            if (mesh.hasUvs())
                mesh.faceUvs[written] = mesh.faceUvs[read];
            ++written;
        }
        if (written - start < 3)
            written = start;
        else
            mesh.faceSizes[faces++] = static_cast<int>(written - start);
    }
    mesh.faceSizes.resize(faces);
    mesh.faceVertices.resize(written);
    if (mesh.hasUvs())
        mesh.faceUvs.resize(written);
}

} // namespace

OpenMesh::VertexHandle FaceListImporter::add_vertex(const OpenMesh::Vec3f& position) {
    mesh_.positions.emplace_back(position[0], position[1], position[2]);
    return OpenMesh::VertexHandle(static_cast<int>(mesh_.positions.size()) - 1);
}

OpenMesh::VertexHandle FaceListImporter::add_vertex() {
    return add_vertex(OpenMesh::Vec3f(0.f));
}

OpenMesh::FaceHandle FaceListImporter::add_face(const VHandles& corners) {
    faceStarts_.push_back(mesh_.faceVertices.size());
    mesh_.faceSizes.push_back(static_cast<int>(corners.size()));
    for (const OpenMesh::VertexHandle& corner : corners)
        mesh_.faceVertices.push_back(corner.idx());
    return OpenMesh::FaceHandle(static_cast<int>(mesh_.faceSizes.size()) - 1);
}

void FaceListImporter::add_face_texcoords(OpenMesh::FaceHandle face, OpenMesh::VertexHandle,
                                          const std::vector<OpenMesh::Vec2f>& uvs) {
    if (!face.is_valid() || uvs.size() != static_cast<std::size_t>(mesh_.faceSizes[face.idx()]))
        return;
    cornerUvs_.resize(mesh_.faceVertices.size(), V2f(none));
    for (std::size_t i = 0; i < uvs.size(); ++i)
        cornerUvs_[faceStarts_[face.idx()] + i] = V2f(uvs[i][0], uvs[i][1]);
}

void FaceListImporter::set_point(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& position) {
    mesh_.positions[vertex.idx()] = V3f(position[0], position[1], position[2]);
}

void FaceListImporter::set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3f& colour) {
    if (colours_.size() < mesh_.positions.size())
        colours_.resize(mesh_.positions.size(), V3f(none));
    colours_[vertex.idx()] = V3f(colour[0], colour[1], colour[2]);
}

void FaceListImporter::set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec4f& colour) {
    set_color(vertex, OpenMesh::Vec3f(colour[0], colour[1], colour[2]));
}

void FaceListImporter::set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec3uc& colour) {
    set_color(vertex, OpenMesh::Vec3f(colour[0] / 255.f, colour[1] / 255.f, colour[2] / 255.f));
}

void FaceListImporter::set_color(OpenMesh::VertexHandle vertex, const OpenMesh::Vec4uc& colour) {
    set_color(vertex, OpenMesh::Vec3uc(colour[0], colour[1], colour[2]));
}

void FaceListImporter::set_texcoord(OpenMesh::VertexHandle vertex, const OpenMesh::Vec2f& uv) {
    if (vertexUvs_.size() < mesh_.positions.size())
        vertexUvs_.resize(mesh_.positions.size(), V2f(none));
    vertexUvs_[vertex.idx()] = V2f(uv[0], uv[1]);
}

void FaceListImporter::reserve(unsigned int vertices, unsigned int, unsigned int faces) {
    mesh_.positions.reserve(vertices);
    mesh_.faceSizes.reserve(faces);
    mesh_.faceVertices.reserve(3 * static_cast<std::size_t>(faces));
    faceStarts_.reserve(faces);
}

void FaceListImporter::takeUvs() {
    if (!vertexUvs_.empty()) {
        // A format with one UV per vertex splits vertices along seams. They are joined again, since a crack along the
        // seams is not what was modelled; the UVs stay with the corners.
        vertexUvs_.resize(mesh_.positions.size(), V2f(none));
        cornerUvs_.resize(mesh_.faceVertices.size());
        const std::vector<int> place = weldedIndices(mesh_.positions);
        for (std::size_t i = 0; i < mesh_.faceVertices.size(); ++i) {
            cornerUvs_[i] = vertexUvs_[mesh_.faceVertices[i]];
            mesh_.faceVertices[i] = place[mesh_.faceVertices[i]];
        }
    }
    if (cornerUvs_.empty())
        return;
    cornerUvs_.resize(mesh_.faceVertices.size(), V2f(none));
    for (const V2f& uv : cornerUvs_)
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
            return;
    // Corners of a vertex with equal UVs share one, so that charts hang together: each vertex keeps a list of its UVs.
    std::vector<int> firstUv(mesh_.positions.size(), -1);
    std::vector<int> nextUv;
    mesh_.faceUvs.reserve(mesh_.faceVertices.size());
    for (std::size_t i = 0; i < mesh_.faceVertices.size(); ++i) {
        const int vertex = mesh_.faceVertices[i];
        int uv = firstUv[vertex];
        while (uv >= 0 && mesh_.uvs[uv] != cornerUvs_[i])
            uv = nextUv[uv];
        if (uv < 0) {
            uv = static_cast<int>(mesh_.uvs.size());
            mesh_.uvs.push_back(cornerUvs_[i]);
            nextUv.push_back(firstUv[vertex]);
            firstUv[vertex] = uv;
        }
        mesh_.faceUvs.push_back(uv);
    }
}

void FaceListImporter::takeCustomProperties() {
    const std::size_t vertices = mesh_.positions.size();
    for (auto it = properties_.vprops_begin(); it != properties_.vprops_end(); ++it) {
        std::vector<float> values;
        if (*it &&
            NumbersOf<float, double, signed char, unsigned char, short, unsigned short, int, unsigned int>::read(
                **it, values) &&
            values.size() == vertices)
            mesh_.vertexAttributes[(*it)->name()] = std::move(values);
    }
    if (colours_.empty())
        return;
    colours_.resize(vertices, V3f(none));
    const char* names[3] = {"red", "green", "blue"};
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<float>& values = mesh_.vertexAttributes[names[channel]];
        values.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i)
            values[i] = colours_[i][channel];
    }
}

void FaceListImporter::dropUnreferenced() {
    std::vector<int> moved(mesh_.positions.size(), -1);
    for (const int vertex : mesh_.faceVertices)
        moved[vertex] = 0;
    int kept = 0;
    for (std::size_t i = 0; i < moved.size(); ++i) {
        if (moved[i] < 0)
            continue;
        moved[i] = kept;
        mesh_.positions[kept] = mesh_.positions[i];
        for (auto& [name, values] : mesh_.vertexAttributes)
            values[kept] = values[i];
        ++kept;
    }
    mesh_.positions.resize(kept);
    for (auto& [name, values] : mesh_.vertexAttributes)
        values.resize(kept);
    for (int& vertex : mesh_.faceVertices)
        vertex = moved[vertex];
    for (Crease& crease : mesh_.creases) {
        crease.a = moved[crease.a];
        crease.b = moved[crease.b];
    }
    for (SharpCorner& corner : mesh_.corners)
        corner.vertex = moved[corner.vertex];
    mesh_.corners.erase(std::remove_if(mesh_.corners.begin(), mesh_.corners.end(),
                                       [](const SharpCorner& corner) { return corner.vertex < 0; }),
                        mesh_.corners.end());
}

void FaceListImporter::dropIncompleteAttributes() {
    for (auto it = mesh_.vertexAttributes.begin(); it != mesh_.vertexAttributes.end();) {
        bool complete = true;
        for (const float value : it->second)
            complete = complete && std::isfinite(value);
        it = complete ? std::next(it) : mesh_.vertexAttributes.erase(it);
    }
}

Mesh FaceListImporter::takeMesh() {
    takeCustomProperties();
    takeUvs();
    dropRepeatedCorners(mesh_);
    dropUnreferenced();
    dropIncompleteAttributes();
    return std::move(mesh_);
}

} // namespace patina
