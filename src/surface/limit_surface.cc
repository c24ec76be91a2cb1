#include "surface/limit_surface.h"

#include "base/errors.h"
#include "surface/cage_topology.h"
#include "surface/triangulate.h"
#include "surface/vertex_normals.h"
#include "surface/weld.h"

#include <fmt/format.h>
#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

namespace patina {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr int deepestLevel = 7;
constexpr double mostTriangles = 4e6;

using Point = Weighted<V3f>;
using Uv = Weighted<V2f>;
using Scalar = Weighted<float>;

/// Every edge of the faces has two of them. `place` names the vertices that count as one (each itself: by index).
bool isClosed(const Mesh& mesh, const std::vector<int>& place) {
    std::vector<std::uint64_t> edges;
    edges.reserve(mesh.faceVertices.size());
    std::size_t start = 0;
    for (const int size : mesh.faceSizes) {
        for (int i = 0; i < size; ++i) {
            const auto a = static_cast<std::uint32_t>(place[mesh.faceVertices[start + i]]);
            const auto b = static_cast<std::uint32_t>(place[mesh.faceVertices[start + (i + 1) % size]]);
            if (a != b)
                edges.push_back(static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b));
        }
        start += size;
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); i += 2)
        if (i + 1 >= edges.size() || edges[i] != edges[i + 1] || (i + 2 < edges.size() && edges[i] == edges[i + 2]))
            return false;
    return !edges.empty();
}

/// Each vertex stands for itself.
std::vector<int> ownIndices(std::size_t count) {
    std::vector<int> indices(count);
    for (std::size_t i = 0; i < count; ++i)
        indices[i] = static_cast<int>(i);
    return indices;
}

/// Each subdivision halves edges: enough of them that half are no longer than the target. The faces of a cage are often
/// long and narrow, and one level more costs a factor of four for the whole model.
int chooseLevel(const Mesh& mesh, double targetEdge, bool trianglesOnly) {
    std::vector<double> edges = edgeLengths(mesh);
    const std::size_t rank = std::min(edges.size() - 1, edges.size() / 2);
    std::nth_element(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(rank), edges.end());
    int level = 1;
    while (level < deepestLevel && edges[rank] * std::ldexp(1.0, -level) > targetEdge)
        ++level;
    // The first Catmull–Clark step makes a quad of every corner; every further one four of each face.
    const auto trianglesAt = [&](int at) {
        return trianglesOnly ? static_cast<double>(mesh.faceSizes.size()) * std::ldexp(1.0, 2 * at)
                             : 2.0 * static_cast<double>(mesh.faceVertices.size()) * std::ldexp(1.0, 2 * (at - 1));
    };
    // A crease that ends is itself only at the level where it does.
    float lasting = 0.f;
    for (const Crease& crease : mesh.creases)
        lasting = std::max(lasting, crease.sharpness < 10.f ? crease.sharpness : 0.f);
    for (const SharpCorner& corner : mesh.corners)
        lasting = std::max(lasting, corner.sharpness < 10.f ? corner.sharpness : 0.f);
    level = std::max(level, std::min(deepestLevel, static_cast<int>(std::ceil(lasting))));
    while (level > 1 && trianglesAt(level) > mostTriangles)
        --level;
    return level;
}

// --- the two ways ---

/// The faces as they are, in triangles.
SurfaceMesh makePlain(const Mesh& mesh) {
    SurfaceMesh surface;
    surface.positions = mesh.positions;
    surface.uvs = mesh.uvs;
    surface.vertexAttributes = mesh.vertexAttributes;
    surface.triangles.reserve(mesh.faceVertices.size());
    surface.triangleFaces.reserve(mesh.faceVertices.size());
    std::vector<V3i> local;
    std::size_t start = 0;
    for (std::size_t face = 0; face < mesh.faceSizes.size(); ++face) {
        const int size = mesh.faceSizes[face];
        const int* corners = mesh.faceVertices.data() + start;
        local.clear();
        triangulatePolygon(mesh.positions, corners, size, local);
        for (const V3i& triangle : local) {
            surface.triangles.emplace_back(corners[triangle.x], corners[triangle.y], corners[triangle.z]);
            surface.triangleFaces.push_back(static_cast<int>(face));
            if (mesh.hasUvs()) {
                const int* uvs = mesh.faceUvs.data() + start;
                surface.triangleUvs.emplace_back(uvs[triangle.x], uvs[triangle.y], uvs[triangle.z]);
            }
        }
        start += size;
    }
    surface.normals = angleWeightedNormals(surface.positions, surface.triangles);
    surface.closed = isClosed(mesh, weldedIndices(mesh.positions));
    return surface;
}

/// Cuts the faces of the last level into triangles and traces each back to its control face.
void diceLastLevel(const Far::TopologyRefiner& refiner, SurfaceMesh& surface) {
    const int depth = refiner.GetMaxLevel();
    std::vector<int> parents = ownIndices(refiner.GetLevel(0).GetNumFaces());
    for (int level = 1; level <= depth; ++level) {
        const Far::TopologyLevel& topology = refiner.GetLevel(level);
        std::vector<int> finer(topology.GetNumFaces());
        for (int face = 0; face < topology.GetNumFaces(); ++face)
            finer[face] = parents[topology.GetFaceParentFace(face)];
        parents.swap(finer);
    }
    const Far::TopologyLevel& last = refiner.GetLevel(depth);
    const bool hasUvs = refiner.GetNumFVarChannels() > 0;
    surface.triangles.reserve(2 * static_cast<std::size_t>(last.GetNumFaces()));
    surface.triangleFaces.reserve(2 * static_cast<std::size_t>(last.GetNumFaces()));
    std::vector<V3i> local;
    for (int face = 0; face < last.GetNumFaces(); ++face) {
        const Far::ConstIndexArray corners = last.GetFaceVertices(face);
        local.clear();
        triangulatePolygon(surface.positions, &corners[0], corners.size(), local);
        for (const V3i& triangle : local) {
            surface.triangles.emplace_back(corners[triangle.x], corners[triangle.y], corners[triangle.z]);
            surface.triangleFaces.push_back(parents[face]);
            if (hasUvs) {
                const Far::ConstIndexArray uvs = last.GetFaceFVarValues(face, 0);
                surface.triangleUvs.emplace_back(uvs[triangle.x], uvs[triangle.y], uvs[triangle.z]);
            }
        }
    }
}

/// Limit normals are the cross product of the limit tangents. Where these are parallel (vertices that are not
/// manifold, collapsed faces) the normal of the diced triangles stands in.
void setLimitNormals(const std::vector<Point>& tangents1, const std::vector<Point>& tangents2, SurfaceMesh& surface) {
    std::vector<int> missing;
    surface.normals.resize(tangents1.size());
    for (std::size_t i = 0; i < tangents1.size(); ++i) {
        const V3d a(tangents1[i].value), b(tangents2[i].value);
        const V3d normal = a.cross(b);
        const double length = normal.length();
        if (length > 1e-6 * a.length() * b.length())
            surface.normals[i] = V3f(normal / length);
        else
            missing.push_back(static_cast<int>(i));
    }
    if (missing.empty())
        return;
    const std::vector<V3f> diced = angleWeightedNormals(surface.positions, surface.triangles);
    for (const int vertex : missing)
        surface.normals[vertex] = diced[vertex];
}

SurfaceMesh makeSubdivided(const Mesh& mesh, Far::TopologyRefiner& refiner, int level) {
    Far::TopologyRefiner::UniformOptions options(level);
    options.fullTopologyInLastLevel = true; // limit masks need the last level's neighbourhoods
    refiner.RefineUniform(options);
    const Far::PrimvarRefiner primvars(refiner);

    SurfaceMesh surface;
    std::vector<Point> points(mesh.positions.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i].value = mesh.positions[i];
    for (int at = 1; at <= level; ++at) {
        std::vector<Point> finer(refiner.GetLevel(at).GetNumVertices());
        primvars.Interpolate(at, points, finer);
        points.swap(finer);
    }
    std::vector<Point> limits(points.size()), tangents1(points.size()), tangents2(points.size());
    primvars.Limit(points, limits, tangents1, tangents2);
    surface.positions.resize(limits.size());
    for (std::size_t i = 0; i < limits.size(); ++i)
        surface.positions[i] = limits[i].value;

    if (mesh.hasUvs()) {
        std::vector<Uv> uvs(mesh.uvs.size());
        for (std::size_t i = 0; i < uvs.size(); ++i)
            uvs[i].value = mesh.uvs[i];
        for (int at = 1; at <= level; ++at) {
            std::vector<Uv> finer(refiner.GetLevel(at).GetNumFVarValues(0));
            primvars.InterpolateFaceVarying(at, uvs, finer, 0);
            uvs.swap(finer);
        }
        std::vector<Uv> limitUvs(uvs.size());
        primvars.LimitFaceVarying(uvs, limitUvs, 0);
        surface.uvs.resize(uvs.size());
        for (std::size_t i = 0; i < uvs.size(); ++i)
            surface.uvs[i] = limitUvs[i].value;
    }
    // Attributes are interpolated linearly: they keep their range, which smooth rules would overshoot.
    for (const auto& [name, values] : mesh.vertexAttributes) {
        std::vector<Scalar> scalars(values.size());
        for (std::size_t i = 0; i < values.size(); ++i)
            scalars[i].value = values[i];
        for (int at = 1; at <= level; ++at) {
            std::vector<Scalar> finer(refiner.GetLevel(at).GetNumVertices());
            primvars.InterpolateVarying(at, scalars, finer);
            scalars.swap(finer);
        }
        std::vector<float>& target = surface.vertexAttributes[name];
        target.resize(scalars.size());
        for (std::size_t i = 0; i < scalars.size(); ++i)
            target[i] = scalars[i].value;
    }
    diceLastLevel(refiner, surface);
    setLimitNormals(tangents1, tangents2, surface);
    surface.closed = isClosed(mesh, ownIndices(mesh.positions.size()));
    return surface;
}

} // namespace

SurfaceMesh makeLimitSurface(const Mesh& mesh, const LimitSurfaceOptions& options) {
    if (mesh.faceSizes.empty())
        throw ModelError(mesh.name, "the model has no faces");
    const bool trianglesOnly =
        std::all_of(mesh.faceSizes.begin(), mesh.faceSizes.end(), [](int size) { return size == 3; });
    SubdivisionScheme scheme = options.scheme;
    if (scheme == SubdivisionScheme::automatic)
        scheme = trianglesOnly ? SubdivisionScheme::none : SubdivisionScheme::catmullClark;
    if (scheme == SubdivisionScheme::none)
        return makePlain(mesh);
    if (scheme == SubdivisionScheme::loop && !trianglesOnly)
        throw ModelError(mesh.name, "Loop subdivision needs a mesh of triangles only",
                         "use the scheme catmull-clark, or triangulate the model");
    if (options.level > deepestLevel)
        throw ModelError(mesh.name, fmt::format("{} subdivisions are more than {}", options.level, deepestLevel),
                         "every subdivision makes four times as many faces");

    const std::unique_ptr<Far::TopologyRefiner> refiner = makeRefiner(mesh, scheme);
    if (!refiner) {
        const char* cause = "its faces do not join into a surface that can be subdivided (an edge shared by faces that "
                            "disagree, or a vertex with too many)";
        if (options.scheme == SubdivisionScheme::automatic) {
            SurfaceMesh surface = makePlain(mesh);
            surface.note = fmt::format("the model is used as it is, not subdivided: {}", cause);
            return surface;
        }
        throw ModelError(mesh.name, cause, "use the scheme none, or repair the model");
    }
    double targetEdge = options.targetEdge;
    if (!(targetEdge > 0.0)) {
        const V3f size = mesh.bounds().size();
        targetEdge = std::max({size.x, size.y, size.z}) / 256.0;
    }
    const int level = options.level >= 0 ? options.level : chooseLevel(mesh, targetEdge, trianglesOnly);
    return makeSubdivided(mesh, *refiner, level);
}

} // namespace patina
