#include "operators/sealed_erosion.h"

#include "operators/map_factors.h"
#include "volume/distance.h"
#include "volume/nest_grids.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// The seeds that face open air.
SurfaceSeeds openSeeds(const DistanceTransform& surface, const OpenAir& air) {
    const SurfaceSeeds& all = surface.seeds();
    const LeafLattice& lattice = surface.levelSet().lattice();
    const auto near = [](float v) { return static_cast<unsigned>(std::clamp(int(std::lround(v)), 0, 7)); };
    SurfaceSeeds open;
    open.points.lattice = BlockBox(all.points.lattice.box());
    for (const PointBlocks::Block& block : all.points.blocks) {
        const auto begin = static_cast<std::uint32_t>(open.points.size());
        const std::int32_t leaf = lattice.at(block.block.x(), block.block.y(), block.block.z());
        const auto number = static_cast<std::uint32_t>(open.points.blocks.size());
        for (std::uint32_t s = block.begin; s < block.end; ++s) {
            const float x = all.points.x[s], y = all.points.y[s], z = all.points.z[s];
            if (leaf >= 0 && air.isSealed(static_cast<std::size_t>(leaf), 64 * near(x) + 8 * near(y) + near(z)))
                continue;
            open.points.x.push_back(x);
            open.points.y.push_back(y);
            open.points.z.push_back(z);
            open.points.blockOf.push_back(number);
            open.patches.push_back(all.patches[s]);
        }
        const auto end = static_cast<std::uint32_t>(open.points.size());
        if (end > begin) {
            open.points.lattice.set(block.block, static_cast<std::int32_t>(number));
            open.points.blocks.push_back({block.block, begin, end});
        }
    }
    return open;
}

} // namespace

std::vector<float> sealedRise(const Workpiece& work, const OpenAir& air, double drawn, const ThicknessMap* map,
                              Progress& progress) {
    const SurfaceBinding& binding = work.binding;
    const NestGrids& grids = work.volume.grids();
    const auto voxelSize = static_cast<float>(work.volume.scale().voxelSize);
    const auto leaves = leavesOf(std::as_const(grids.surface().tree()));
    std::vector<float> rise(binding.leafStart(leaves.size()), 0.f);
    const DistanceTransform surface(grids.surface(), voxelSize);
    const SurfaceSeeds open = openSeeds(surface, air);
    progress.checkpoint();
    if (open.points.size() == 0)
        return rise;
    const NearestPoints search(open.points);
    const auto furthest = static_cast<float>(drawn / voxelSize + 2.0);
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        const FloatLeaf& leaf = *leaves[n];
        const float* phi = leaf.buffer().data();
        std::uint64_t wanted[8] = {};
        bool any = false;
        forActive(leaf, [&](openvdb::Index pos) {
            if (air.isSealed(n, pos) && !(phi[pos] > 0.f)) {
                wanted[pos >> 6] |= std::uint64_t(1) << (pos & 63);
                any = true;
            }
        });
        if (!any)
            return;
        NearestInBlock& near = scratch.local();
        const openvdb::Coord block(leaf.origin() >> 3);
        SearchWindow window;
        window.mask = wanted;
        window.furthest = furthest;
        search.search(block, window, near);
        if (!near.any)
            return;
        std::size_t at = binding.leafStart(n);
        ClampedFactors clamped;
        forActive(leaf, [&](openvdb::Index pos) {
            const std::size_t here = at++;
            if (!(wanted[pos >> 6] >> (pos & 63) & 1) || near.point[pos] < 0)
                return;
            const Imath::V3f x(float(pos >> 6), float((pos >> 3) & 7), float(pos & 7));
            const Imath::V3f foot = open.footOf(block, x, near.point[pos]);
            const double distance = -double((foot - x).length()) * voxelSize;
            if (distance + drawn <= phi[pos])
                return;
            const openvdb::Coord& o = leaf.origin();
            const Imath::V3d place = Imath::V3d(o.x(), o.y(), o.z()) + Imath::V3d(foot);
            const SurfacePoint under = binding.closest(place * voxelSize);
            if (under.triangle < 0)
                return;
            const double t = drawn * (map ? clampedFactor(*map, binding.surface(), under, clamped) : 1.0);
            rise[here] = static_cast<float>(std::max(0.0, distance + t - phi[pos]));
        });
    });
    progress.checkpoint();
    return rise;
}

} // namespace patina
