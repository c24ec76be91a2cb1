#include "operators/sealed_erosion.h"

#include "operators/map_factors.h"
#include "volume/distance.h"
#include "volume/nest_grids.h"
#include "volume/nest_sampler.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

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

constexpr float unreached = std::numeric_limits<float>::infinity();

// How far a voxel is from the surface that faces open air, in voxels, and the thickness (scene units) that the map asks
// for at that place; 512 values a leaf.
struct Reach {
    explicit Reach(std::size_t leaves) : away(512 * leaves, unreached), thickness(512 * leaves, 0.f) {}
    std::vector<float> away, thickness;
};

// Whether metal lies between two points (voxels). A fifth of a voxel of it is none: paths may graze it.
bool metalBetween(const NestSampler& sampler, double voxelSize, const Imath::V3d& from, const Imath::V3d& to) {
    const int steps = static_cast<int>(std::ceil((to - from).length() / 0.5));
    for (int i = 1; i < steps; ++i)
        if (sampler.value(0, sampler.locate(from + (to - from) * (double(i) / steps))) < -0.2 * voxelSize)
            return true;
    return false;
}

// Carries distances on from the voxels that see open surface to those that metal hides from it, from voxel to voxel
// round the metal (26 neighbours: up to a twelfth too long), and from there a little into the metal, whose voxels are
// the far ends of cells that hold layers. No way leads through metal.
void goRoundMetal(const std::vector<const FloatLeaf*>& leaves, const std::vector<const FloatLeaf*>& floor,
                  const OpenAir& air, float furthest, Reach& reach) {
    const LeafLattice lattice(leaves);
    using Stop = std::pair<float, std::size_t>;
    std::priority_queue<Stop, std::vector<Stop>, std::greater<Stop>> stops;
    for (std::size_t at = 0; at < reach.away.size(); ++at)
        if (reach.away[at] < unreached)
            stops.emplace(reach.away[at], at);
    while (!stops.empty()) {
        const auto [away, at] = stops.top();
        stops.pop();
        if (away > reach.away[at])
            continue;
        const openvdb::Coord here =
            leaves[at / 512]->origin().offsetBy(int(at % 512) >> 6, (int(at % 512) >> 3) & 7, int(at % 512) & 7);
        const bool fromMetal = !(floor[at / 512]->buffer().data()[at % 512] > 0.f);
        for (int i = 0; i < 27; ++i) {
            const openvdb::Coord step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1), next = here + step;
            const std::int32_t leaf = lattice.at(next.x() >> 3, next.y() >> 3, next.z() >> 3);
            const auto pos = static_cast<unsigned>(64 * (next.x() & 7) + 8 * (next.y() & 7) + (next.z() & 7));
            if (leaf < 0 || !leaves[leaf]->isValueOn(pos) || !air.isSealed(static_cast<std::size_t>(leaf), pos) ||
                (fromMetal && floor[leaf]->buffer().data()[pos] > 0.f))
                continue;
            const std::size_t to = 512 * static_cast<std::size_t>(leaf) + pos;
            const float longer =
                away + std::sqrt(static_cast<float>(step.x() * step.x() + step.y() * step.y() + step.z() * step.z()));
            if (longer < reach.away[to] && longer <= furthest) {
                reach.away[to] = longer;
                reach.thickness[to] = reach.thickness[at];
                stops.emplace(longer, to);
            }
        }
    }
}

} // namespace

std::vector<float> sealedRise(const Workpiece& work, const OpenAir& air, double drawn, const ThicknessMap* map,
                              bool throughMetal, Progress& progress) {
    const SurfaceBinding& binding = work.binding;
    const NestGrids& grids = work.volume.grids();
    const auto voxelSize = static_cast<float>(work.volume.scale().voxelSize);
    const auto leaves = leavesOf(std::as_const(grids.surface().tree()));
    const auto floor = leavesOf(std::as_const(grids.floor().tree()));
    std::vector<float> rise(binding.leafStart(leaves.size()), 0.f);
    const DistanceTransform surface(grids.surface(), voxelSize);
    const SurfaceSeeds open = openSeeds(surface, air);
    progress.checkpoint();
    if (open.points.size() == 0)
        return rise;
    const NearestPoints search(open.points);
    const NestSampler sampler(grids);
    const auto furthest = static_cast<float>(drawn / voxelSize + 2.0);
    Reach reach(leaves.size());
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        const FloatLeaf& leaf = *leaves[n];
        const float* phi = leaf.buffer().data();
        const float* metal = floor[n]->buffer().data();
        std::uint64_t wanted[8] = {};
        bool any = false;
        forActive(leaf, [&](openvdb::Index pos) {
            if (air.isSealed(n, pos) && (throughMetal ? !(phi[pos] > 0.f) : metal[pos] > 0.f)) {
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
        ClampedFactors clamped;
        const Imath::V3d origin = sampler.position(leaf.origin());
        forActive(leaf, [&](openvdb::Index pos) {
            if (!(wanted[pos >> 6] >> (pos & 63) & 1) || near.point[pos] < 0)
                return;
            const Imath::V3f x(float(pos >> 6), float((pos >> 3) & 7), float(pos & 7));
            const Imath::V3f foot = open.footOf(block, x, near.point[pos]);
            const float away = (foot - x).length();
            if (away > furthest)
                return;
            const Imath::V3d place = origin + Imath::V3d(foot);
            if (!throughMetal && metalBetween(sampler, voxelSize, origin + Imath::V3d(x), place))
                return;
            const SurfacePoint under = binding.closest(place * voxelSize);
            if (under.triangle < 0)
                return;
            const double factor = map ? clampedFactor(*map, binding.surface(), under, clamped) : 1.0;
            reach.away[512 * n + pos] = away;
            reach.thickness[512 * n + pos] = static_cast<float>(drawn * factor);
        });
    });
    progress.checkpoint();
    if (!throughMetal)
        goRoundMetal(leaves, floor, air, furthest, reach);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        const float* phi = leaves[n]->buffer().data();
        std::size_t at = binding.leafStart(n);
        forActive(*leaves[n], [&](openvdb::Index pos) {
            const std::size_t here = at++;
            if (phi[pos] > 0.f || !(reach.away[512 * n + pos] < unreached))
                return;
            const double distance = -double(reach.away[512 * n + pos]) * voxelSize;
            rise[here] = static_cast<float>(std::max(0.0, distance + reach.thickness[512 * n + pos] - phi[pos]));
        });
    });
    return rise;
}

} // namespace patina
