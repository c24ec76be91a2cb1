// RDR: random deposition with surface relaxation (paper section 3.3; Family 1986): a particle moves to the lowest place
// within reach.

#include "operators/growth/growth_run.h"

#include <algorithm>

namespace patina {

namespace {

/// The lowest place among a cell and its neighbours; the cell itself where it is as low as any, otherwise one of the
/// lowest at random. Compared are whole levels, floor(particles / area + a number 0 … 1 of the cell's own): on a flat
/// lattice that is the particles, and where areas differ from cell to cell it is as high in the mean. Thicknesses
/// themselves would tie nowhere, and all particles would drift to where cells are larger: on a sphere, out of the six
/// places that face along the axes (5.5 per cent of the layer at an age of 20).
struct RelaxationRule {
    const std::vector<std::array<int, 4>>& neighbours;
    const std::vector<float>& thicknessPerParticle;
    const std::vector<float>& offset; ///< 0 … 1, per cell, and what relief there is
    std::vector<std::uint32_t>& level;
    std::vector<std::uint32_t>& count;
    int reach;
    std::uint64_t particles = 0;
    std::vector<int> ball;           ///< cells within reach, nearest first
    std::vector<std::uint32_t> mark; ///< the last particle that looked at a cell
    std::uint32_t stamp = 0;

    void prefetch(std::uint32_t cell) const {
        __builtin_prefetch(&neighbours[cell]);
        __builtin_prefetch(&level[cell], 1);
    }
    void operator()(std::uint32_t cell, std::uint32_t time, std::uint32_t) {
        const int place = reach == 1 ? lowestBeside(cell, time) : lowestWithin(cell, time);
        ++count[place];
        level[place] = static_cast<std::uint32_t>(float(count[place]) * thicknessPerParticle[place] + offset[place]);
        ++particles;
    }
    int lowestBeside(std::uint32_t cell, std::uint32_t time) const {
        // The least of (level, rank, slot) packed into one number: the cell itself has rank 0, its neighbours have the
        // ranks 1 to 4 in one of the 24 orders at random, so that ties are broken evenly without branches.
        const auto& n = neighbours[cell];
        const auto& rank = orders()[pick(time, 24)];
        const auto packed = [this](int place, std::uint64_t low) {
            return std::uint64_t(level[std::size_t(place)]) << 8 | low;
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
        std::uint32_t lowest = level[cell];
        std::uint32_t ties = 0;
        for (const int place : ball) {
            if (level[place] < lowest) {
                lowest = level[place];
                ties = 0;
            }
            ties += level[place] == lowest;
        }
        if (level[cell] == lowest)
            return static_cast<int>(cell);
        std::uint32_t nth = pick(time, ties);
        for (const int place : ball)
            if (level[place] == lowest && nth-- == 0)
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
    const KeyedRandom offsets = run.random("levels");
    std::vector<float> offset(lattice.size());
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        thickness[i] = 1.f / lattice.areas[i];
        const Imath::V3i& key = lattice.keys[i];
        // Below 1 in single precision, too.
        offset[i] = float(offsets.words(0, key.x, key.y, key.z)[0] >> 8) / float(1 << 24);
        if (!run.options.relief.empty())
            offset[i] += std::max(0.f, run.options.relief[i]);
    }
    GrownHeights grown;
    std::vector<std::uint32_t> count(lattice.size(), 0), level(offset.begin(), offset.end());
    RelaxationRule rule{neighbours, thickness, offset, level, count, run.options.reach, 0, {}, {}, 0};
    if (run.options.reach > 1)
        rule.mark.assign(lattice.size(), 0);
    grown.arrivals = followArrivals(clock, 0.0, run.age, run.progress, rule);
    grown.particles = rule.particles;
    grown.height.resize(lattice.size());
    for (std::size_t i = 0; i < lattice.size(); ++i)
        grown.height[i] = static_cast<float>(count[i]) * thickness[i];
    return grown;
}

} // namespace patina
