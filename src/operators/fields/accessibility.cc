#include "operators/fields/accessibility.h"

#include "operators/fields/passages.h"
#include "operators/fields/tangent_spheres.h"
#include "volume/distance.h"
#include "volume/nest_grids.h"
#include "volume/surface_contacts.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

// The largest sphere at p, no larger than the local one, that can come from outside. Spheres at p are nested, so where
// one can come all smaller ones can.
float fromOutside(const Passages& passages, const V3f& p, const V3f& normal, float local) {
    float reachable = 0.f, tooLarge = local;
    if (passages.reaches(p + normal * local, local))
        return local;
    while (tooLarge - reachable > 0.05f) {
        const float radius = 0.5f * (reachable + tooLarge);
        (passages.reaches(p + normal * radius, radius) ? reachable : tooLarge) = radius;
    }
    return reachable;
}

} // namespace

std::vector<float> accessibleRadii(const LayerVolume& volume, const SurfaceVoxels& surface, int layer,
                                   double limitVoxels, bool global, Progress& progress) {
    const auto limit = static_cast<float>(limitVoxels);
    const DistanceTransform transform(*volume.grids().nest()[layer], volume.scale().voxelSize);
    const SurfaceSeeds& seeds = transform.seeds();
    const SurfaceContacts contacts(transform.levelSet(), seeds, volume.scale().voxelSize);
    const IndexSpace& space = volume.grids().space;
    const TangentSpheres spheres(contacts, space);
    std::vector<float> radii(surface.size(), limit);
    std::unique_ptr<Passages> passages;
    if (global)
        passages = std::make_unique<Passages>(volume, layer, surface, limitVoxels, progress);
    const std::size_t leaves = surface.leafStart.empty() ? 0 : surface.leafStart.size() - 1;
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), leaves, [&](std::size_t leaf) {
        const std::size_t begin = surface.leafStart[leaf], end = surface.leafStart[leaf + 1];
        if (begin == end || progress.cancelled())
            return;
        // The point under each voxel as the closing has it: on the patch of the nearest seed.
        const openvdb::Coord block = space.index(surface.voxels[begin]) >> 3;
        const V3f origin(space.position(block << 3));
        const auto numberOf = [&](const V3i& place) {
            const openvdb::Coord v = space.index(place);
            return 64 * (v.x() & 7) + 8 * (v.y() & 7) + (v.z() & 7);
        };
        std::uint64_t wanted[8] = {};
        for (std::size_t i = begin; i < end; ++i)
            wanted[numberOf(surface.voxels[i]) >> 6] |= std::uint64_t(1) << (numberOf(surface.voxels[i]) & 63);
        SearchWindow window;
        window.mask = wanted;
        NearestInBlock& near = scratch.local();
        transform.nearest(block, window, near);
        int guess = -1;
        for (std::size_t i = begin; i < end; ++i) {
            const std::int32_t seed = near.point[numberOf(surface.voxels[i])];
            if (seed < 0)
                continue; // no surface at all
            const TouchPoint under = seeds.pointUnder(block, V3f(surface.voxels[i]) - origin, seed);
            const V3f p = origin + under.foot;
            radii[i] = 0.f;
            for (int n = 0; n < under.count && radii[i] < limit; ++n) {
                const TangentSpheres::Touch touch = spheres.largest(p, under.normals[n], limit, guess);
                guess = touch.seed;
                radii[i] = std::max(
                    radii[i], passages ? fromOutside(*passages, p, under.normals[n], touch.radius) : touch.radius);
            }
        }
    });
    progress.checkpoint();
    return radii;
}

} // namespace patina
