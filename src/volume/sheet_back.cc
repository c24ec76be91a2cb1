#include "volume/sheet_back.h"

#include "surface/mesh_topology.h"
#include "surface/ray_scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

namespace {

constexpr double leastThickness = 0.2; // of what was asked for

// How far each vertex of the open shells may be moved back, so that the back stays clear of what lies behind it.
std::vector<float> depthsOf(const SurfaceMesh& surface, const MeshTopology& topology, const std::vector<char>& isOpen,
                            double thickness) {
    std::vector<char> wanted(surface.positions.size(), 0);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (int c = 0; c < 3 && isOpen[t]; ++c)
            wanted[surface.triangles[t][c]] = 1;
    std::vector<float> depth(surface.positions.size(), static_cast<float>(thickness));
    const RayScene scene(surface.positions, surface.triangles);
    tbb::parallel_for(std::size_t(0), depth.size(), [&](std::size_t v) {
        if (!wanted[v])
            return;
        const auto hit = scene.intersect(surface.positions[v], -surface.normals[v], static_cast<float>(1e-3 * thickness),
                                         static_cast<float>(2.0 * thickness));
        if (!hit)
            return;
        for (int c = 0; c < 3; ++c)
            if (surface.positions[surface.triangles[hit->point.triangle][c]] == surface.positions[v])
                return; // its own face
        depth[v] = static_cast<float>(std::clamp(0.5 * hit->distance, leastThickness * thickness, thickness));
    });
    // The back may not slope more than one in two, so that it comes clear of an edge that only some vertices see.
    for (bool again = true; again;) {
        again = false;
        for (std::size_t t = 0; t < surface.triangles.size(); ++t)
            for (int c = 0; c < 3 && isOpen[t]; ++c) {
                const int a = surface.triangles[t][c], b = surface.triangles[t][(c + 1) % 3];
                const float most = 0.5f * (surface.positions[a] - surface.positions[b]).length();
                if (std::abs(depth[a] - depth[b]) <= most * 1.0001f)
                    continue;
                (depth[a] > depth[b] ? depth[a] : depth[b]) = std::min(depth[a], depth[b]) + most;
                again = true;
            }
    }
    // Vertices at one place stay together.
    std::vector<float> together(depth.size(), std::numeric_limits<float>::infinity());
    for (std::size_t v = 0; v < depth.size(); ++v) {
        float& least = together[topology.place(static_cast<int>(v))];
        least = std::min(least, depth[v]);
    }
    for (std::size_t v = 0; v < depth.size(); ++v)
        depth[v] = together[topology.place(static_cast<int>(v))];
    return depth;
}

} // namespace

ClosedSurface closeSurface(const SurfaceMesh& surface, double thickness) {
    ClosedSurface closed;
    closed.positions = surface.positions;
    closed.triangles = surface.triangles;
    closed.frontTriangles = closed.firstRimTriangle = surface.triangles.size();
    if (surface.closed)
        return closed;

    std::vector<int> starts(surface.triangles.size() + 1);
    for (std::size_t t = 0; t < starts.size(); ++t)
        starts[t] = static_cast<int>(3 * t);
    std::vector<int> corners;
    corners.reserve(3 * surface.triangles.size());
    for (const Imath::V3i& t : surface.triangles)
        corners.insert(corners.end(), {t[0], t[1], t[2]});
    const MeshTopology topology(surface.positions, starts, corners.data());
    std::vector<char> isOpen(surface.triangles.size(), 0);
    for (std::size_t t = 0; t < isOpen.size(); ++t)
        isOpen[t] = topology.shellOf(t) >= 0 && !topology.openSides(topology.shellOf(t)).empty();
    if (std::find(isOpen.begin(), isOpen.end(), 1) == isOpen.end())
        return closed;

    const std::vector<float> depth = depthsOf(surface, topology, isOpen, thickness);
    const int count = static_cast<int>(surface.positions.size());
    closed.positions.reserve(2 * surface.positions.size());
    for (int v = 0; v < count; ++v)
        closed.positions.push_back(surface.positions[v] - surface.normals[v] * depth[v]);
    for (std::size_t t = 0; t < isOpen.size(); ++t) {
        const Imath::V3i& c = surface.triangles[t];
        if (isOpen[t])
            closed.triangles.emplace_back(c[0] + count, c[2] + count, c[1] + count);
    }
    closed.firstRimTriangle = closed.triangles.size();
    for (int shell = 0; shell < topology.shellCount(); ++shell)
        for (const MeshTopology::Side& side : topology.openSides(shell)) {
            // The face's own vertices at the side's places.
            int a = side.from, b = side.to;
            ClosedSurface::OpenSide& open = closed.openSides.emplace_back(ClosedSurface::OpenSide{side.face, 0, 1});
            for (int c = 0; c < 3; ++c) {
                const int v = surface.triangles[side.face][c];
                if (topology.place(v) == side.from) {
                    a = v;
                    open.from = c;
                }
                if (topology.place(v) == side.to) {
                    b = v;
                    open.to = c;
                }
            }
            if (topology.turned(side.face))
                std::swap(a, b);
            closed.triangles.emplace_back(b, a, a + count);
            closed.triangles.emplace_back(b, a + count, b + count);
        }
    return closed;
}

} // namespace patina
