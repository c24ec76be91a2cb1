#include "render/voxel_surface.h"

#include "surface/ray_scene.h"
#include "surface/vertex_normals.h"
#include "volume/interface_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace patina {

using Imath::V3f;

namespace {

constexpr float facing = 0.3f; // cosine: what one surface's normals are away from each other at most

// How far the slope of a level set is to be believed, 0…1. Differences over a voxel reach across a gap that is
// narrower, where both sides cancel and what is left points anywhere.
float trustIn(const V3f& slope, const V3f& outward) {
    const float t = std::clamp(((slope ^ outward) - 0.3f) / 0.3f, 0.f, 1.f);
    return t * t * (3.f - 2.f * t);
}

bool faces(const SurfaceMesh& mesh, int triangle, const V3f& direction) {
    const Imath::V3i& corners = mesh.triangles[std::size_t(triangle)];
    const V3f a = mesh.positions[std::size_t(corners.x)];
    const V3f normal = (mesh.positions[std::size_t(corners.y)] - a).cross(mesh.positions[std::size_t(corners.z)] - a);
    return (normal ^ direction) > facing * normal.length();
}

V3f shadingNormal(const V3f& ofModel, const V3f& outward, const V3f& slope, const V3f& baseSlope) {
    const float trust = trustIn(slope, outward);
    // Over a thin edge the model's normal may look the other way: the interface's own is right there.
    if ((ofModel ^ outward) > facing) {
        const float both = trust * trustIn(baseSlope, outward);
        const V3f tilted = both > 0.f ? ofModel + (slope.normalized() - baseSlope.normalized()) * both : ofModel;
        if (tilted.length2() > 0.04f)
            return tilted.normalized();
    }
    return trust > 0.f ? (outward * (1.f - trust) + slope.normalized() * trust).normalized() : outward;
}

} // namespace

VoxelSurface voxelSurface(const LayerVolume& volume, const SurfaceMesh& model,
                          const std::function<SurfaceMesh(const SurfaceMesh&)>& cut) {
    VoxelSurface surface;
    SurfaceMesh& shown = surface.shown;
    shown = interfaceMesh(volume, volume.layerCount());
    // Which way is out is told by the triangles: the level set's slope is of no use in narrow gaps.
    shown.normals = angleWeightedNormals(shown.positions, shown.triangles);
    if (cut) {
        shown = cut(shown);
        settleOnInterface(volume, volume.layerCount(), shown);
    }
    SurfaceMesh& under = surface.under;
    under.positions.resize(shown.positions.size());
    under.normals.resize(shown.positions.size());
    under.triangles = shown.triangles;
    const std::vector<V3f> slopes = interfaceSlopes(volume, volume.layerCount(), shown.positions);
    const std::vector<V3f> baseSlopes = patina::baseSlopes(volume, shown.positions);
    const RayScene rays(model.positions, model.triangles);
    const float voxel = float(volume.scale().voxelSize);
    tbb::parallel_for(std::size_t(0), shown.positions.size(), [&](std::size_t v) {
        const V3f& outward = shown.normals[v];
        auto nearest = rays.closest(shown.positions[v]);
        // The other side of a gap may be nearer than the own one.
        if (!faces(model, nearest->point.triangle, outward))
            if (const auto own = rays.closestFacing(shown.positions[v], outward, nearest->distance + 1.5f * voxel))
                nearest = own;
        under.positions[v] = V3f(positionAt(model, nearest->point));
        under.normals[v] = V3f(normalAt(model, nearest->point));
        shown.normals[v] = shadingNormal(under.normals[v], outward, slopes[v], baseSlopes[v]);
    });
    return surface;
}

} // namespace patina
