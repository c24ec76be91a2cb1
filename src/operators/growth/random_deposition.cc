// RD (paper section 3.3): a particle falls on the column below it and stays there.

#include "operators/growth/growth_run.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace patina {

GrownHeights growRandomDeposition(const GrowthRun& run) {
    // Columns do not know of each other, so arrivals need no order: heights are Poisson counts.
    const GrowthLattice& lattice = run.lattice;
    const ArrivalClock clock(lattice, run.random("arrivals"), run.random("thinning"), ArrivalClock::Rate::perArea,
                             run.options.arrival);
    GrownHeights grown;
    grown.height.resize(lattice.size());
    std::vector<std::uint32_t> counts(lattice.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lattice.size(), 2048), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            counts[i] = clock.count(i, run.age);
            grown.height[i] = static_cast<float>(double(counts[i]) / lattice.areas[i]);
        }
    });
    for (const std::uint32_t count : counts)
        grown.particles += count;
    return grown;
}

} // namespace patina
