// DPD_BS: directed percolation depinning (Barabási and Stanley 1995, chapter 10; Buldyrev et al. 1992): an interface
// creeps upwards through a medium of blocked and unblocked voxels until blocks pin it.

#include "operators/growth/growth_run.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

/// A column's candidates are the dry voxels that touch wet ones: the one on top, and those beside higher neighbours.
/// The highest unblocked one becomes wet, and all below it with it.
struct DepinningRule {
    const std::vector<std::array<int, 4>>& neighbours;
    const std::vector<Imath::V3i>& keys;
    std::vector<std::int32_t>& height;
    const GrowthRun& run;
    KeyedRandom blocks;
    std::uint64_t particles = 0;

    void prefetch(std::uint32_t cell) const {
        __builtin_prefetch(&neighbours[cell]);
        __builtin_prefetch(&height[cell], 1);
    }
    void operator()(std::uint32_t cell, std::uint32_t, std::uint32_t) {
        const auto& n = neighbours[cell];
        const std::int32_t low = height[cell];
        const std::int32_t high = std::max({low + 1, height[n[0]], height[n[1]], height[n[2]], height[n[3]]});
        for (std::int32_t level = high; level > low; --level) {
            if (blocked(cell, static_cast<std::uint32_t>(level)))
                continue;
            particles += static_cast<std::uint64_t>(level - low);
            height[cell] = level;
            return;
        }
    }
    bool blocked(std::uint32_t cell, std::uint32_t level) const {
        const Imath::V3i& key = keys[cell];
        return uniformFromWord(blocks.words(level / 4, key.x, key.y, key.z)[level % 4]) < run.blockedAt(cell);
    }
};

} // namespace

GrownHeights growBarabasiStanley(const GrowthRun& run) {
    const ArrivalClock clock(run.lattice, run.random("arrivals"), run.random("thinning"), ArrivalClock::Rate::perCell,
                             run.options.arrival);
    const auto neighbours = closedNeighbours(run.lattice);
    std::vector<std::int32_t> height(run.lattice.size(), 0);
    DepinningRule rule{neighbours, run.lattice.keys, height, run, run.random("blocks"), 0};
    GrownHeights grown;
    grown.arrivals = followArrivals(clock, 0.0, run.age, run.progress, rule);
    grown.particles = rule.particles;
    grown.height.assign(height.begin(), height.end());
    return grown;
}

} // namespace patina
