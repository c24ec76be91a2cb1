#pragma once
// When particles arrive where: independent Poisson clocks, one per cell, read from keyed random numbers.

#include "base/progress.h"
#include "base/random.h"
#include "operators/growth/growth_lattice.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace patina {

/// Time is cut into intervals of one monolayer. What happens in an interval at a cell is a function of the key, the
/// interval and the cell's lattice coordinate only: a Poisson count and that many times, uniform in the interval. So a
/// longer history contains the shorter one, and a piece of the lattice sees what it sees in the whole.
class ArrivalClock {
  public:
    enum class Rate {
        perCell, ///< one particle per cell and monolayer
        perArea, ///< one per cell² of surface and monolayer
    };

    /// An arrival: its time within the interval (upper 32 bits, 2^32 to an interval) and its cell (lower 32 bits).
    using Arrival = std::uint64_t;

    /// \param arrival fraction of the particles that arrive, per cell; empty: all. The rest are thinned out by numbers
    ///        of their own, so that a larger fraction keeps every particle of a smaller one.
    ArrivalClock(const GrowthLattice& lattice, const KeyedRandom& clock, const KeyedRandom& thinning, Rate rate,
                 const std::vector<float>& arrival);

    /// Particles that arrive at a cell in the whole intervals and the last broken one that make up `age`. Where nobody
    /// asks when they come this is quicker than interval(), and draws numbers of its own.
    std::uint32_t count(std::size_t cell, double age) const;

    /// All arrivals of an interval up to `end` (0…1] of it, in order of time, then cell.
    void interval(std::uint32_t interval, double end, std::vector<Arrival>& arrivals) const;

    std::size_t cells() const { return lattice_.size(); }

  private:
    std::uint32_t draw(std::size_t cell, std::uint32_t word) const;
    template <class Visit>
    void visit(std::size_t cell, std::uint32_t interval, std::uint64_t end, Visit&& visit) const;

    const GrowthLattice& lattice_;
    KeyedRandom clock_;
    KeyedRandom thinning_;
    std::vector<float> noArrival_; ///< probability that a cell sees no particle in an interval; empty: 1/e everywhere
    const std::vector<float>& arrival_;
};

/// Hands every arrival from `since` up to `age` to rule(cell, time word, interval) in order of time, one after the
/// other, while the next interval's arrivals are being drawn. rule.prefetch(cell) is called a little ahead. A history
/// followed to `since` and then from there is the one followed at once. \return how many they were
/// \throws Interrupted when cancelled.
template <class Rule>
std::uint64_t followArrivals(const ArrivalClock& clock, double since, double age, Progress* progress, Rule&& rule) {
    constexpr std::size_t ahead = 12;
    const auto first = static_cast<std::uint32_t>(since);
    const auto intervals = static_cast<std::uint32_t>(std::ceil(age));
    const auto endOf = [age](std::uint32_t i) { return std::min(1.0, age - i); };
    std::vector<ArrivalClock::Arrival> now, next;
    if (intervals > first)
        clock.interval(first, endOf(first), now);
    // The word that ended the interval which was broken off.
    const auto begun = static_cast<std::uint64_t>((since - first) * 4294967296.0) << 32;
    std::uint64_t count = 0;
    for (std::uint32_t i = first; i < intervals; ++i) {
        if (progress)
            progress->checkpoint();
        const auto apply = [&] {
            const std::size_t start =
                i > first ? 0 : std::size_t(std::lower_bound(now.begin(), now.end(), begun) - now.begin());
            count += now.size() - start;
            for (std::size_t n = start; n < now.size(); ++n) {
                if (n + ahead < now.size())
                    rule.prefetch(static_cast<std::uint32_t>(now[n + ahead]));
                rule(static_cast<std::uint32_t>(now[n]), static_cast<std::uint32_t>(now[n] >> 32), i);
            }
        };
        if (i + 1 < intervals)
            tbb::parallel_invoke([&] { clock.interval(i + 1, endOf(i + 1), next); }, apply);
        else
            apply();
        now.swap(next);
    }
    return count;
}

} // namespace patina
