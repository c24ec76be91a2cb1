#pragma once
// What a grown layer looks like in numbers.

#include "operators/growth/growth_lattice.h"

#include <cstdint>
#include <vector>

namespace patina {

/// Heights in layers (of one cell's thickness), weighted by area.
struct GrowthStatistics {
    std::uint64_t particles = 0; ///< that stayed
    std::uint64_t arrivals = 0;  ///< that were followed for it: where a history went on, those since then (RD, ST: none)
    double mean = 0.0;
    double interfaceWidth = 0.0; ///< rms deviation of the height (Rq)
    double skewness = 0.0;
    double coverage = 0.0;   ///< fraction of the area that is covered at all
    double density = 0.0;    ///< solid below the interface: 1 for compact layers, 0.3 for a ballistic one
    std::size_t patches = 0; ///< connected covered pieces
    double levelFactor = 0.0; ///< of grow(): the factor of a layer; times the thickness of a coat what it is worth
    double levelUm = 0.0;     ///< of a coat: what a layer of these heights is worth, real µm
};

/// Everything but `particles`, `arrivals` and `density`.
GrowthStatistics measureHeights(const GrowthLattice& lattice, const std::vector<float>& heights);

} // namespace patina
