#include "operators/fields/open_places.h"

#include <tbb/parallel_for.h>

#include <limits>

namespace patina {

using Imath::V3f;

Obstacles Obstacles::of(const RayScene& scene) {
    return {[&scene](const V3f& o, const V3f& d) {
                return scene.occluded(o, d, 0.f, std::numeric_limits<float>::infinity());
            },
            [&scene](const V3f& o, const V3f& d, float farthest) { return scene.firstFace(o, d, farthest); }};
}

namespace {

// Voxels: from where the triangles are looked for, how deep below that, and how far above them rays leave.
constexpr float searchFrom = 0.3f, searchDepth = 1.3f, clearance = 0.01f;
constexpr float wideFace = 4.f; // voxels: narrower triangles follow a bent surface, whose normal the voxels know better

} // namespace

OpenPlaces openPlaces(const SurfaceVoxels& surface, double voxelSize, const Obstacles& obstacles) {
    const auto size = static_cast<float>(voxelSize);
    OpenPlaces places;
    places.points.resize(surface.size());
    places.normals = surface.normals;
    places.flat.resize(surface.size());
    tbb::parallel_for(std::size_t(0), surface.size(), [&](std::size_t i) {
        V3f& normal = places.normals[i];
        V3f point = surface.feet[i] + normal * searchFrom;
        if (const auto hit = obstacles.first(point * size, -normal, searchDepth * size)) {
            point -= normal * (hit->distance / size);
            if (hit->width >= wideFace * size && hit->normal.dot(normal) > 0.f) {
                normal = hit->normal;
                places.flat[i] = 1;
            }
            point += normal * clearance;
        }
        places.points[i] = point;
    });
    return places;
}

} // namespace patina
