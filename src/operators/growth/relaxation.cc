// RDR: random deposition with surface relaxation (paper section 3.3; Family 1986): a particle moves to the lowest place
// within reach.

#include "operators/growth/growth_run.h"

#include <algorithm>
#include <cstring>

namespace patina {

namespace {

/// The lowest place among a cell and its neighbours; the cell itself where it is as low as any, otherwise one of the
/// lowest at random. Compares thickness (particles over area), which is a whole number of particles on a flat lattice.
struct RelaxationRule {
    const std::vector<std::array<int, 4>>& neighbours;
    const std::vector<float>& thicknessPerParticle;
    std::vector<float>& height;
    std::vector<std::uint32_t>& count;
    int reach;
    std::uint64_t particles = 0;
    std::vector<int> ball;           ///< cells within reach, nearest first
    std::vector<std::uint32_t> mark; ///< the last particle that looked at a cell
    std::uint32_t stamp = 0;

    void prefetch(std::uint32_t cell) const {
        __builtin_prefetch(&neighbours[cell]);
        __builtin_prefetch(&height[cell], 1);
    }
    void operator()(std::uint32_t cell, std::uint32_t time, std::uint32_t) {
        const int place = reach == 1 ? lowestBeside(cell, time) : lowestWithin(cell, time);
        ++count[place];
        height[place] = static_cast<float>(count[place]) * thicknessPerParticle[place];
        ++particles;
    }
    int lowestBeside(std::uint32_t cell, std::uint32_t time) const {
        // The least of (height, rank, slot) packed into one number: the cell itself has rank 0, its neighbours have the
        // ranks 1 to 4 in one of the 24 orders at random, so that ties are broken evenly without branches. Heights are
        // not negative, so their bits are in the order of their values.
        const auto& n = neighbours[cell];
        const auto& rank = orders()[pick(time, 24)];
        const auto packed = [this](int place, std::uint64_t low) {
            std::uint32_t bits;
            std::memcpy(&bits, &height[place], sizeof bits);
            return std::uint64_t(bits) << 8 | low;
        };
        std::uint64_t least = packed(static_cast<int>(cell), 4);
        for (unsigned slot = 0; slot < 4; ++slot)
            least = std::min(least, packed(n[slot], std::uint64_t(rank[slot]) << 4 | slot));
        const std::array<int, 5> places = {n[0], n[1], n[2], n[3], static_cast<int>(cell)};
        return places[least & 7];
    }
    /// The 24 orders of the numbers 1 to 4.
    static const std::array<std::array<std::uint8_t, 4>, 24>& orders() {
        static constexpr auto table = [] {
            std::array<std::array<std::uint8_t, 4>, 24> all{};
            int count = 0;
            for (std::uint8_t a = 1; a <= 4; ++a)
                for (std::uint8_t b = 1; b <= 4; ++b)
                    for (std::uint8_t c = 1; c <= 4; ++c)
                        if (a != b && a != c && b != c)
                            all[count++] = {a, b, c, static_cast<std::uint8_t>(10 - a - b - c)};
            return all;
        }();
        return table;
    }
    int lowestWithin(std::uint32_t cell, std::uint32_t time) {
        ++stamp;
        ball.assign(1, static_cast<int>(cell));
        mark[cell] = stamp;
        std::size_t ringStart = 0;
        for (int ring = 0; ring < reach; ++ring) {
            const std::size_t ringEnd = ball.size();
            for (std::size_t i = ringStart; i < ringEnd; ++i)
                for (const int next : neighbours[ball[i]])
                    if (mark[next] != stamp) {
                        mark[next] = stamp;
                        ball.push_back(next);
                    }
            ringStart = ringEnd;
        }
        float lowest = height[cell];
        std::uint32_t ties = 0;
        for (const int place : ball) {
            if (height[place] < lowest) {
                lowest = height[place];
                ties = 0;
            }
            ties += height[place] == lowest;
        }
        if (height[cell] == lowest)
            return static_cast<int>(cell);
        std::uint32_t nth = pick(time, ties);
        for (const int place : ball)
            if (height[place] == lowest && nth-- == 0)
                return place;
        return static_cast<int>(cell);
    }
    /// The low half of an arrival's time has no say in the order of arrivals, so it serves as a die.
    static std::uint32_t pick(std::uint32_t time, std::uint32_t choices) { return ((time & 0xffffu) * choices) >> 16; }
};

} // namespace

GrownHeights growRelaxation(const GrowthRun& run) {
    const GrowthLattice& lattice = run.lattice;
    const ArrivalClock clock(lattice, run.random("arrivals"), run.random("thinning"), ArrivalClock::Rate::perArea,
                             run.options.arrival);
    const auto neighbours = closedNeighbours(lattice);
    std::vector<float> thickness(lattice.size());
    for (std::size_t i = 0; i < lattice.size(); ++i)
        thickness[i] = 1.f / lattice.areas[i];
    GrownHeights grown;
    grown.height.assign(lattice.size(), 0.f);
    std::vector<std::uint32_t> count(lattice.size(), 0);
    RelaxationRule rule{neighbours, thickness, grown.height, count, run.options.reach, 0, {}, {}, 0};
    if (run.options.reach > 1)
        rule.mark.assign(lattice.size(), 0);
    followArrivals(clock, run.age, run.progress, rule);
    grown.particles = rule.particles;
    return grown;
}

} // namespace patina
