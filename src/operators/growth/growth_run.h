#pragma once
// What every model is handed: inside the room only.

#include "base/progress.h"
#include "base/random.h"
#include "operators/growth/arrival_clock.h"
#include "operators/growth/growth_lattice.h"
#include "operators/growth/growth_options.h"
#include "operators/growth/level_occupancy.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// What a model gives back.
struct GrownHeights {
    std::vector<float> height;   ///< layers
    std::uint64_t particles = 0; ///< that stayed
    std::uint64_t arrivals = 0;  ///< that this run has followed
    double solid = -1.0;         ///< solid volume in cell³; negative: as much as the heights hold (compact)
};

struct GrowthRun {
    const GrowthLattice& lattice;
    const GrowthOptions& options;
    double age;
    std::uint64_t seed;
    std::string_view label;
    Progress* progress;
    LevelOccupancy* occupancy = nullptr; ///< where given, BD notes the place of every particle
    /// Where given, BD and DPD go on from what had grown at the age `since`; other models begin anew.
    const GrownHeights* earlier = nullptr;
    double since = 0.0;

    /// A stream of random numbers of this history, for one of the model's purposes.
    KeyedRandom random(std::string_view purpose) const {
        return KeyedRandom(seed, label, growthModelName(options.model) + "/" + std::string(purpose));
    }
    double arrivalAt(std::size_t cell) const { return options.arrival.empty() ? 1.0 : options.arrival[cell]; }
    double blockedAt(std::size_t cell) const {
        return options.blocked.empty() ? options.blockedFraction : options.blocked[cell];
    }
};

GrownHeights growSteadyThickening(const GrowthRun& run);
GrownHeights growRandomDeposition(const GrowthRun& run);
GrownHeights growRelaxation(const GrowthRun& run);
GrownHeights growBallisticDeposition(const GrowthRun& run);
GrownHeights growDirectedPercolation(const GrowthRun& run);
GrownHeights growBarabasiStanley(const GrowthRun& run);

/// Neighbours with a missing one replaced by the cell itself: to every rule here a cell is its own harmless neighbour.
std::vector<std::array<int, 4>> closedNeighbours(const GrowthLattice& lattice);

} // namespace patina
