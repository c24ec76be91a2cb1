#include "render/voxel_surface.h"

#include "render/settling.h"
#include "surface/ray_scene.h"
#include "surface/vertex_normals.h"
#include "volume/interface_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace patina {

using Imath::V3f;

namespace {

constexpr float facing = 0.3f; // cosine: what one surface's normals are away from each other at most

float smoothStep(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.f, 1.f);
    return t * t * (3.f - 2.f * t);
}

// How far the slope of a level set is to be believed, 0…1. Differences over a voxel reach across a gap that is
// narrower, where both sides cancel and what is left points anywhere.
float trustIn(const V3f& slope, const V3f& outward) {
    return smoothStep(0.3f, 0.6f, slope ^ outward);
}

bool faces(const SurfaceMesh& mesh, int triangle, const V3f& direction) {
    const Imath::V3i& corners = mesh.triangles[std::size_t(triangle)];
    const V3f a = mesh.positions[std::size_t(corners.x)];
    const V3f normal = (mesh.positions[std::size_t(corners.y)] - a).cross(mesh.positions[std::size_t(corners.z)] - a);
    return (normal ^ direction) > facing * normal.length();
}

// The interface's own normal at a vertex.
struct OwnNormal {
    V3f normal;
    float trust; // share of the level set's slope in it, the rest is the triangles'
};

// \param lies  the settled triangles' normal, rough in narrow gaps; nothing shown may face away from it
OwnNormal ownNormal(const V3f& outward, const V3f& lies, const V3f& slope) {
    const float trust = trustIn(slope, outward) * smoothStep(0.f, facing, slope ^ lies);
    return {trust > 0.f ? (outward * (1.f - trust) + slope.normalized() * trust).normalized() : outward, trust};
}

// \param cut  voxels that the base lies inside the model's point
V3f shadingNormal(const V3f& ofModel, float cut, const OwnNormal& own, const V3f& lies, const V3f& slope,
                  const V3f& baseSlope) {
    // Over a thin edge the model's normal may look the other way, and a crease that the voxels fill has another shape:
    // the interface's own is right there. An edge that the voxels round off the model keeps.
    const float edge = smoothStep(0.02f, 0.1f, cut);
    const float trustInModel =
        smoothStep(0.75f + (facing - 0.75f) * edge, 0.95f + (0.5f - 0.95f) * edge, ofModel ^ own.normal) *
        smoothStep(0.f, facing, ofModel ^ lies);
    if (trustInModel == 0.f)
        return own.normal;
    const float both = own.trust * trustIn(baseSlope, own.normal);
    const V3f tilted = both > 0.f ? ofModel + (slope.normalized() - baseSlope.normalized()) * both : ofModel;
    const V3f mixed = own.normal * (1.f - trustInModel) + tilted.normalized() * trustInModel;
    return mixed.length2() > 0.04f ? mixed.normalized() : own.normal;
}

} // namespace

VoxelSurface voxelSurface(const LayerVolume& volume, const SurfaceMesh& model,
                          const std::function<SurfaceMesh(const SurfaceMesh&)>& split) {
    VoxelSurface surface;
    SurfaceMesh& shown = surface.shown;
    shown = interfaceMesh(volume, volume.layerCount());
    // Which way is out is told by the triangles: the level set's slope is of no use in narrow gaps.
    shown.normals = angleWeightedNormals(shown.positions, shown.triangles);
    if (split) {
        shown = split(shown);
        settle(volume, shown);
    }
    SurfaceMesh& under = surface.under;
    under.positions.resize(shown.positions.size());
    under.normals.resize(shown.positions.size());
    under.triangles = shown.triangles;
    const std::vector<V3f> slopes = interfaceSlopes(volume, volume.layerCount(), shown.positions);
    const std::vector<V3f> baseSlopes = patina::baseSlopes(volume, shown.positions);
    const std::vector<V3f> lies = angleWeightedNormals(shown.positions, shown.triangles);
    const RayScene rays(model.positions, model.triangles);
    const float voxel = float(volume.scale().voxelSize), blend = 0.3f * voxel;
    std::vector<OwnNormal> own(shown.positions.size());
    std::vector<V3f> ofModel(shown.positions.size());
    tbb::parallel_for(std::size_t(0), shown.positions.size(), [&](std::size_t v) {
        own[v] = ownNormal(shown.normals[v], lies[v], slopes[v]);
        const V3f &at = shown.positions[v], &outward = own[v].normal;
        auto nearest = rays.closest(at);
        // The other side of a gap may be nearer than the own one.
        if (!faces(model, nearest->point.triangle, outward))
            if (const auto same = rays.closestFacing(at, outward, nearest->distance + 1.5f * voxel))
                nearest = same;
        under.positions[v] = V3f(positionAt(model, nearest->point));
        under.normals[v] = ofModel[v] = V3f(normalAt(model, nearest->point));
        if ((ofModel[v] ^ outward) > 0.98f)
            return;
        // Beside a crease or an edge, which the voxels round, the surface goes from one side to the other and back.
        if (const auto other = rays.closestFacing(at, outward, nearest->distance + blend, ofModel[v])) {
            const float share = 0.5f - 0.5f * smoothStep(0.f, blend, other->distance - nearest->distance);
            ofModel[v] = (ofModel[v] * (1.f - share) + V3f(normalAt(model, other->point)) * share).normalized();
        }
    });
    const std::vector<float> cut = baseDistances(volume, under.positions);
    tbb::parallel_for(std::size_t(0), shown.positions.size(), [&](std::size_t v) {
        shown.normals[v] = shadingNormal(ofModel[v], cut[v], own[v], lies[v], slopes[v], baseSlopes[v]);
    });
    return surface;
}

} // namespace patina
