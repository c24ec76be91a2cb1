// BD (paper section 3.3; Vold; Barabási and Stanley chapter 2): a particle sticks at first contact, sideways too.

#include "operators/growth/growth_run.h"
#include "operators/growth/oblique_track.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// An even coat below is often a half or a whole number of levels thick: rounding must not make steps of its last bits.
constexpr float betweenLevels = 0.137f;

template <bool notesPlaces>
struct BallisticRule {
    const std::vector<std::array<int, 4>>& neighbours;
    std::vector<std::int32_t>& height; ///< relief and particles
    const std::vector<std::int32_t>& relief;
    LevelOccupancy* occupancy;

    void prefetch(std::uint32_t cell) const {
        __builtin_prefetch(&neighbours[cell]);
        __builtin_prefetch(&height[cell], 1);
    }
    /// h <- max[h(neighbours), h + 1]
    void operator()(std::uint32_t cell, std::uint32_t, std::uint32_t) {
        const auto& n = neighbours[cell];
        height[cell] = std::max({height[cell] + 1, height[n[0]], height[n[1]], height[n[2]], height[n[3]]});
        if (notesPlaces)
            occupancy->add(cell, height[cell] - relief[cell]);
    }
};

/// Particles on slanted tracks: the cell of an arrival is the one its track would reach on the bare lattice.
struct ObliqueRule {
    ObliqueTrack& track;
    std::vector<std::int32_t>& height;
    const std::vector<std::int32_t>& relief;
    LevelOccupancy& occupancy;
    std::int32_t highest = 0;
    std::uint64_t particles = 0;

    void prefetch(std::uint32_t cell) const { __builtin_prefetch(&height[cell]); }
    void operator()(std::uint32_t cell, std::uint32_t time, std::uint32_t) {
        const auto place = track.firstContact(int(cell), time, height, highest, occupancy);
        const auto at = static_cast<std::size_t>(place.cell);
        occupancy.add(at, place.level - relief[at]);
        height[at] = std::max(height[at], place.level);
        highest = std::max(highest, place.level);
        ++particles;
    }
};

std::uint64_t depositFrom(const GrowthRun& run, const ArrivalClock& clock, std::vector<std::int32_t>& height,
                          const std::vector<std::int32_t>& relief) {
    ObliqueTrack track(run.lattice, run.options.from, run.options.levelHeight, relief);
    LevelOccupancy own(run.occupancy ? 0 : run.lattice.size());
    ObliqueRule rule{track, height, relief, run.occupancy ? *run.occupancy : own};
    for (const std::int32_t h : height)
        rule.highest = std::max(rule.highest, h);
    followArrivals(clock, 0.0, run.age, run.progress, rule);
    return rule.particles;
}

template <bool notesPlaces>
std::uint64_t deposit(const GrowthRun& run, const ArrivalClock& clock, std::vector<std::int32_t>& height,
                      const std::vector<std::int32_t>& relief) {
    const auto neighbours = closedNeighbours(run.lattice);
    return followArrivals(clock, run.since, run.age, run.progress,
                          BallisticRule<notesPlaces>{neighbours, height, relief, run.occupancy});
}

} // namespace

GrownHeights growBallisticDeposition(const GrowthRun& run) {
    const ArrivalClock clock(run.lattice, run.random("arrivals"), run.random("thinning"), ArrivalClock::Rate::perCell,
                             run.options.arrival);
    std::vector<std::int32_t> relief(run.lattice.size(), 0);
    for (std::size_t i = 0; i < run.options.relief.size(); ++i)
        relief[i] = static_cast<std::int32_t>(std::lround(run.options.relief[i] + betweenLevels));
    std::vector<std::int32_t> height = relief;
    if (run.earlier)
        for (std::size_t i = 0; i < height.size(); ++i)
            height[i] += static_cast<std::int32_t>(run.earlier->height[i]);
    GrownHeights grown;
    if (run.options.from != Imath::V3d(0.0))
        grown.arrivals = depositFrom(run, clock, height, relief);
    else
        grown.arrivals =
            run.occupancy ? deposit<true>(run, clock, height, relief) : deposit<false>(run, clock, height, relief);
    grown.particles = grown.arrivals + (run.earlier ? run.earlier->particles : 0);
    grown.height.resize(height.size());
    for (std::size_t i = 0; i < height.size(); ++i)
        grown.height[i] = static_cast<float>(height[i] - relief[i]);
    // Each particle fills its cell for one layer, and where it lands does not depend on the cell's area.
    double area = 0.0;
    for (const float a : run.lattice.areas)
        area += a;
    grown.solid = run.lattice.size() ? double(grown.particles) * area / double(run.lattice.size()) : 0.0;
    return grown;
}

} // namespace patina
