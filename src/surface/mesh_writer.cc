#include "base/atomic_file.h"
#include "base/errors.h"
#include "surface/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

namespace patina {

using Imath::V2f;
using Imath::V3f;
using Imath::V3i;

// OpenMesh writes neither UVs per corner nor numbers that read back to the same bits, hence writers of our own.

namespace {

const std::vector<float>* find(const std::map<std::string, std::vector<float>>& attributes, const char* name,
                               std::size_t count) {
    const auto it = attributes.find(name);
    return it != attributes.end() && it->second.size() == count ? &it->second : nullptr;
}

/// The attributes red, green and blue, where there are all three: formats have a place of their own for them.
struct Colours {
    const std::vector<float>* channels[3];
    Colours(const std::map<std::string, std::vector<float>>& attributes, std::size_t count)
        : channels{find(attributes, "red", count), find(attributes, "green", count), find(attributes, "blue", count)} {}
    bool all() const { return channels[0] && channels[1] && channels[2]; }
    static bool isName(const std::string& name) { return name == "red" || name == "green" || name == "blue"; }
};

void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
    AtomicFile file(path);
    {
        std::ofstream stream(file.temporary(), std::ios::binary);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        stream.close();
        if (!stream)
            throw RunError(path.string(), "the file cannot be written", "check that the disk is not full");
    }
    file.commit();
}

void append(std::string& bytes, std::uint32_t word) {
    const char little[4] = {static_cast<char>(word & 0xff), static_cast<char>(word >> 8 & 0xff),
                            static_cast<char>(word >> 16 & 0xff), static_cast<char>(word >> 24)};
    bytes.append(little, 4);
}

void append(std::string& bytes, float value) {
    std::uint32_t word;
    std::memcpy(&word, &value, sizeof word);
    append(bytes, word);
}

/// A word of a PLY header.
std::string headerName(const std::string& name) {
    std::string word = name.empty() ? "attribute" : name;
    for (char& c : word)
        if (c <= ' ' || c > '~')
            c = '_';
    // These names have a meaning of their own.
    for (const char* taken : {"x", "y", "z", "nx", "ny", "nz", "s", "t", "u", "v", "red", "green", "blue", "alpha"})
        if (word == taken)
            return "attribute_" + word;
    return word;
}

/// A vertex of PLY: one position and one UV. Vertices keep their order; those on a seam are repeated at the end.
struct SplitVertices {
    std::vector<int> vertex; ///< of the surface
    std::vector<int> uv;
    std::vector<V3i> triangles;

    explicit SplitVertices(const SurfaceMesh& surface) {
        const std::size_t count = surface.positions.size();
        vertex.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            vertex[i] = static_cast<int>(i);
        triangles = surface.triangles;
        if (!surface.hasUvs())
            return;
        uv.assign(count, -1);
        std::vector<int> next(count, -1);
        for (std::size_t i = 0; i < triangles.size(); ++i)
            for (int corner = 0; corner < 3; ++corner) {
                int at = surface.triangles[i][corner];
                const int wanted = surface.triangleUvs[i][corner];
                if (uv[at] < 0)
                    uv[at] = wanted;
                while (uv[at] != wanted && next[at] >= 0)
                    at = next[at];
                if (uv[at] != wanted) {
                    next[at] = static_cast<int>(vertex.size());
                    at = next[at];
                    vertex.push_back(surface.triangles[i][corner]);
                    uv.push_back(wanted);
                    next.push_back(-1);
                }
                triangles[i][corner] = at;
            }
    }
};

} // namespace

void writeObj(const Mesh& mesh, const std::filesystem::path& path, const std::vector<V3f>* normals) {
    if (normals && normals->size() != mesh.positions.size())
        throw RunError(path.string(),
                       fmt::format("{} normals for {} vertices", normals->size(), mesh.positions.size()));
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "# {} vertices, {} faces\n", mesh.positions.size(), mesh.faceSizes.size());
    const Colours colours(mesh.vertexAttributes, mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3f& p = mesh.positions[i];
        if (colours.all())
            fmt::format_to(out, "v {} {} {} {} {} {}\n", p.x, p.y, p.z, (*colours.channels[0])[i],
                           (*colours.channels[1])[i], (*colours.channels[2])[i]);
        else
            fmt::format_to(out, "v {} {} {}\n", p.x, p.y, p.z);
    }
    for (const V2f& uv : mesh.uvs)
        fmt::format_to(out, "vt {} {}\n", uv.x, uv.y);
    if (normals)
        for (const V3f& n : *normals)
            fmt::format_to(out, "vn {} {} {}\n", n.x, n.y, n.z);
    std::size_t at = 0;
    for (const int size : mesh.faceSizes) {
        text.push_back('f');
        for (int corner = 0; corner < size; ++corner, ++at) {
            const int vertex = mesh.faceVertices[at] + 1;
            fmt::format_to(out, " {}", vertex);
            if (mesh.hasUvs())
                fmt::format_to(out, "/{}", mesh.faceUvs[at] + 1);
            if (normals)
                fmt::format_to(out, "{}/{}", mesh.hasUvs() ? "" : "/", vertex);
        }
        text.push_back('\n');
    }
    for (const Crease& crease : mesh.creases)
        fmt::format_to(out, "t crease 2/1/0 {} {} {}\n", crease.a, crease.b, crease.sharpness);
    for (const SharpCorner& corner : mesh.corners)
        fmt::format_to(out, "t corner 1/1/0 {} {}\n", corner.vertex, corner.sharpness);
    writeBytes(path, fmt::to_string(text));
}

void writePly(const SurfaceMesh& surface, const std::filesystem::path& path) {
    const SplitVertices split(surface);
    const Colours colours(surface.vertexAttributes, surface.positions.size());
    std::vector<const std::vector<float>*> attributes;
    std::string bytes =
        fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                    "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n",
                    split.vertex.size());
    if (surface.hasUvs())
        bytes += "property float s\nproperty float t\n";
    if (colours.all())
        bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    for (const auto& [name, values] : surface.vertexAttributes) {
        if (values.size() != surface.positions.size() || (colours.all() && Colours::isName(name)))
            continue;
        bytes += fmt::format("property float {}\n", headerName(name));
        attributes.push_back(&values);
    }
    bytes +=
        fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", split.triangles.size());
    bytes.reserve(bytes.size() + split.vertex.size() * (35 + 4 * attributes.size()) + 13 * split.triangles.size());
    for (std::size_t i = 0; i < split.vertex.size(); ++i) {
        const int vertex = split.vertex[i];
        for (int axis = 0; axis < 3; ++axis)
            append(bytes, surface.positions[vertex][axis]);
        for (int axis = 0; axis < 3; ++axis)
            append(bytes, surface.normals[vertex][axis]);
        if (surface.hasUvs()) {
            const V2f uv = split.uv[i] >= 0 ? surface.uvs[split.uv[i]] : V2f(0.f);
            append(bytes, uv.x);
            append(bytes, uv.y);
        }
        if (colours.all())
            for (const std::vector<float>* channel : colours.channels) {
                const float value = std::min(1.f, std::max(0.f, (*channel)[vertex]));
                bytes.push_back(static_cast<char>(static_cast<unsigned char>(std::lround(255.f * value))));
            }
        for (const std::vector<float>* values : attributes)
            append(bytes, (*values)[vertex]);
    }
    for (const V3i& triangle : split.triangles) {
        bytes.push_back(3);
        for (int corner = 0; corner < 3; ++corner)
            append(bytes, static_cast<std::uint32_t>(triangle[corner]));
    }
    writeBytes(path, bytes);
}

} // namespace patina
