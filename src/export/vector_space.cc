#include "export/vector_space.h"

#include "base/errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace patina {

using Imath::V2d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

/// A vertex of one chart and one handedness.
struct CornerKey {
    int vertex, uv;
    bool mirrored;
    bool operator==(const CornerKey& o) const { return vertex == o.vertex && uv == o.uv && mirrored == o.mirrored; }
};
struct CornerHash {
    std::size_t operator()(const CornerKey& key) const {
        const std::uint64_t bits =
            (std::uint64_t(std::uint32_t(key.vertex)) << 32 | std::uint32_t(key.uv)) * 2 + key.mirrored;
        return static_cast<std::size_t>(bits * 0x9e3779b97f4a7c15ull >> 7);
    }
};

V3d acrossOf(const V3d& normal) {
    const V3d axis = std::abs(normal.x) < 0.6 ? V3d(1, 0, 0) : V3d(0, 1, 0);
    return (axis - normal * normal.dot(axis)).normalized();
}

V3d flattened(const V3d& vector, const V3d& normal) {
    return vector - normal * normal.dot(vector);
}

} // namespace

const char* nameOf(VectorSpace space) {
    return space == VectorSpace::object ? "object" : space == VectorSpace::blender ? "blender" : "materialx";
}

VectorSpace vectorSpaceNamed(const std::string& name) {
    for (const VectorSpace space : {VectorSpace::object, VectorSpace::blender, VectorSpace::materialx})
        if (name == nameOf(space))
            return space;
    throw RunError(name, "is no space of vector displacement", "these are object, blender and materialx");
}

VectorFrames::VectorFrames(const SurfaceMesh& surface) : surface_(surface) {
    const std::size_t count = surface.triangles.size();
    corners_.resize(count);
    mirrored_.resize(count);
    std::unordered_map<CornerKey, int, CornerHash> numbers;
    numbers.reserve(surface.positions.size() * 2);
    std::vector<V3d> sums;
    std::vector<int> vertices;
    // One after the other: the sums do not depend on threads.
    for (std::size_t t = 0; t < count; ++t) {
        const V3i& at = surface.triangles[t];
        const V3i& uv = surface.triangleUvs[t];
        const V2d e1(surface.uvs[uv.y] - surface.uvs[uv.x]), e2(surface.uvs[uv.z] - surface.uvs[uv.x]);
        const V3d p1(surface.positions[at.y] - surface.positions[at.x]);
        const V3d p2(surface.positions[at.z] - surface.positions[at.x]);
        const double area = e1.x * e2.y - e1.y * e2.x;
        mirrored_[t] = area < 0.0;
        const V3d along = (p1 * e2.y - p2 * e1.y) * (area < 0.0 ? -1.0 : 1.0);
        for (int c = 0; c < 3; ++c) {
            const auto [found, isNew] = numbers.try_emplace({at[c], uv[c], area < 0.0}, static_cast<int>(sums.size()));
            if (isNew) {
                sums.emplace_back(0.0);
                vertices.push_back(at[c]);
            }
            corners_[t][c] = found->second;
            const V3d normal(surface.normals[at[c]]);
            const V3d here(surface.positions[at[c]]);
            const V3d a = flattened(V3d(surface.positions[at[(c + 1) % 3]]) - here, normal);
            const V3d b = flattened(V3d(surface.positions[at[(c + 2) % 3]]) - here, normal);
            const V3d tangent = flattened(along, normal);
            const double lengths = a.length() * b.length();
            if (area == 0.0 || !(lengths > 0.0) || !(tangent.length() > 0.0))
                continue;
            sums[found->second] += tangent.normalized() * std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0));
        }
    }
    tangents_.resize(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        tangents_[i] =
            V3f(sums[i].length() > 1e-6 ? sums[i].normalized() : acrossOf(V3d(surface.normals[vertices[i]])));
}

VectorFrames::Frame VectorFrames::at(const SurfacePoint& point) const {
    const V3i& corner = corners_[point.triangle];
    Frame frame;
    frame.normal = normalAt(surface_, point);
    const V3d tangent = V3d(tangents_[corner.x]) * (1.0 - point.u - point.v) + V3d(tangents_[corner.y]) * point.u +
                        V3d(tangents_[corner.z]) * point.v;
    frame.tangent = flattened(tangent, frame.normal).length() > 1e-3 ? tangent.normalized() : acrossOf(frame.normal);
    frame.bitangent = frame.normal.cross(frame.tangent).normalized() * (mirrored_[point.triangle] ? -1.0 : 1.0);
    return frame;
}

V3d toSpace(VectorSpace space, const VectorFrames::Frame& frame, const V3d& vector) {
    if (space == VectorSpace::object)
        return vector;
    // The bitangent is at right angles to both others; these need not be to each other.
    const double slant = frame.tangent.dot(frame.normal);
    const double along = (vector.dot(frame.tangent) - slant * vector.dot(frame.normal)) / (1.0 - slant * slant);
    const double up = vector.dot(frame.normal) - slant * along;
    const double across = vector.dot(frame.bitangent);
    return space == VectorSpace::blender ? V3d(along, up, across) : V3d(along, across, up);
}

V3d fromSpace(VectorSpace space, const VectorFrames::Frame& frame, const V3d& channels) {
    if (space == VectorSpace::object)
        return channels;
    const double up = space == VectorSpace::blender ? channels.y : channels.z;
    const double across = space == VectorSpace::blender ? channels.z : channels.y;
    return frame.tangent * channels.x + frame.normal * up + frame.bitangent * across;
}

} // namespace patina
