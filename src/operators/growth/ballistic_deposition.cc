// BD (paper section 3.3; Vold; Barabási and Stanley chapter 2): a particle sticks at first contact, sideways too.

#include "operators/growth/growth_run.h"

#include <algorithm>

namespace patina {

namespace {

struct BallisticRule {
    const std::vector<std::array<int, 4>>& neighbours;
    std::vector<std::int32_t>& height;
    std::uint64_t particles = 0;

    void prefetch(std::uint32_t cell) const {
        __builtin_prefetch(&neighbours[cell]);
        __builtin_prefetch(&height[cell], 1);
    }
    /// h <- max[h(neighbours), h + 1]
    void operator()(std::uint32_t cell, std::uint32_t, std::uint32_t) {
        const auto& n = neighbours[cell];
        height[cell] = std::max({height[cell] + 1, height[n[0]], height[n[1]], height[n[2]], height[n[3]]});
        ++particles;
    }
};

} // namespace

GrownHeights growBallisticDeposition(const GrowthRun& run) {
    const ArrivalClock clock(run.lattice, run.random("arrivals"), run.random("thinning"), ArrivalClock::Rate::perCell,
                             run.options.arrival);
    const auto neighbours = closedNeighbours(run.lattice);
    std::vector<std::int32_t> height(run.lattice.size(), 0);
    BallisticRule rule{neighbours, height};
    followArrivals(clock, run.age, run.progress, rule);

    GrownHeights grown;
    grown.particles = rule.particles;
    grown.height.assign(height.begin(), height.end());
    // Each particle fills its cell for one layer, and where it lands does not depend on the cell's area.
    double area = 0.0;
    for (const float a : run.lattice.areas)
        area += a;
    grown.solid = run.lattice.size() ? double(rule.particles) * area / double(run.lattice.size()) : 0.0;
    return grown;
}

} // namespace patina
