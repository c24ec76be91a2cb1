#pragma once
// Lets a layer grow on a lattice: one entry for all the models.

#include "base/progress.h"
#include "operators/growth/growth_lattice.h"
#include "operators/growth/growth_options.h"
#include "operators/growth/growth_statistics.h"
#include "operators/growth/level_occupancy.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace patina {

/// One value per cell of the lattice.
struct GrowthPattern {
    std::vector<float> height; ///< of the interface, in layers of one cell's thickness
    std::vector<float> factor; ///< 0…1: what a coat's thickness is multiplied by
    GrowthStatistics statistics;
};

/// The model's own mean and deviation of the height, of an endless plane with full arrival.
struct GrowthScale {
    double mean = 0.0;
    double sigma = 0.0;
    /// The height that counts as factor 1.
    double top() const { return mean + 3.0 * sigma; }
};

/// Grows the pattern of options.step. The same seed, label and model make one history: a larger age goes on where a
/// smaller one stopped (heights never fall), a piece of a model grows as the whole does from growthMarginCells inward
/// of the cut, and the bits do not depend on the number of threads.
/// Particles: RD and RDR particles are of one volume and arrive per area, so a cell of area a collects a of them per
/// monolayer, each 1/a layers thick. BD, DPD and DPD_BS speak of cells: one per cell and monolayer, each one layer
/// thick. Factors are heights over GrowthScale::top(), clamped to 0…1. \throws RunError for options out of range or
/// vectors that do not fit the lattice; Interrupted when cancelled.
GrowthPattern grow(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                   std::string_view label, Progress* progress = nullptr);

/// Whether growOn() does less than grow(): BD but from a direction, and DPD.
bool goesOn(const GrowthOptions& options);

/// The same, going on from the pattern that an earlier step of the same history made (options.step aside, its options
/// were these): the same bits, for the work of what has grown since where goesOn(). Others grow from the start.
GrowthPattern growOn(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                     std::string_view label, const GrowthPattern& earlier, double earlierStep,
                     Progress* progress = nullptr);

/// The heights alone, without factors (and the reference plane they cost) and statistics.
std::vector<float> growHeights(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                               std::string_view label, Progress* progress = nullptr);

/// Where the sample points of ST lie (scene units): no two closer than options.pointSpacing cells in a straight line,
/// and no place of the surface further than two such spacings from one.
std::vector<Imath::V3d> samplePoints(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                                     std::string_view label);

/// A ballistic layer particle by particle.
struct GrownParticles {
    std::vector<float> height; ///< of the envelope, levels above `foot`
    std::vector<float> foot;   ///< level of the history on which what is asked for begins; empty: 0
    LevelOccupancy occupancy;  ///< levels that particles fill, those below `foot` included
    GrowthStatistics statistics;
};

/// The history of grow() for BD, with the place of every particle. `since` is an earlier step of it (below
/// options.step): only what has grown from then on counts, each column standing on what it had grown before.
/// \throws RunError for another model; as grow()
GrownParticles growParticles(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                             std::string_view label, Progress* progress = nullptr, double since = 0.0);

/// Mean and deviation by which factors are made, at the age of the step, or of the last step where options.ofFull.
/// In closed form for RD, otherwise of the same model on a reference plane with a key of its own: never of the object.
/// The vectors of the options are left out.
GrowthScale expectedScale(const GrowthOptions& options);

/// How far from a cut (in cells) a pattern may differ from that of the whole model: RD 0, ST by its point spacing, the
/// others by how fast news travels along the surface.
double growthMarginCells(const GrowthOptions& options);

} // namespace patina
