#include "volume/distance.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <cmath>

namespace patina {

DistanceTransform::DistanceTransform(const openvdb::FloatGrid& grid, double voxelSize, double iso)
    : levelSet_(grid), seeds_(makeSurfaceSeeds(levelSet_, voxelSize, iso)), search_(seeds_.points) {}

DistanceField distanceToInterface(const LayerVolume& volume, int k, const DistanceOptions& options,
                                  Progress& progress) {
    const NestGrids& grids = volume.grids();
    const openvdb::FloatGrid& grid = k == 0 ? grids.floor() : *grids.interfaces[k - 1];
    const auto voxelSize = static_cast<float>(volume.scale().voxelSize);
    const DistanceTransform transform(grid, volume.scale().voxelSize);
    progress.checkpoint();

    const auto& leaves = transform.levelSet().leaves();
    std::vector<std::size_t> start(leaves.size() + 1, 0);
    for (std::size_t n = 0; n < leaves.size(); ++n)
        start[n + 1] = start[n] + leaves[n]->onVoxelCount();
    DistanceField field;
    field.distance.resize(start.back());
    if (options.feet)
        field.toFoot.assign(start.back(), Imath::V3f(0.f));

    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        const FloatLeaf& leaf = *leaves[n];
        const float* phi = leaf.buffer().data();
        std::uint64_t wanted[8] = {};
        bool any = false;
        forActive(leaf, [&](openvdb::Index pos) {
            if (phi[pos] > 0.f ? options.outside : options.inside) {
                wanted[pos >> 6] |= std::uint64_t(1) << (pos & 63);
                any = true;
            }
        });
        NearestInBlock& near = scratch.local();
        const openvdb::Coord block(leaf.origin() >> 3);
        SearchWindow window;
        window.mask = wanted;
        if (any)
            transform.nearest(block, window, near);
        std::size_t at = start[n];
        forActive(leaf, [&](openvdb::Index pos) {
            const std::size_t here = at++;
            field.distance[here] = phi[pos];
            const bool asked = wanted[pos >> 6] >> (pos & 63) & 1;
            if (!asked || near.point[pos] < 0)
                return;
            const Imath::V3f away = transform.toFoot(block, static_cast<int>(pos), near.point[pos]);
            field.distance[here] = std::copysign(away.length() * voxelSize, phi[pos]);
            if (options.feet)
                field.toFoot[here] = away;
        });
    });
    progress.checkpoint();
    return field;
}

} // namespace patina
