// DPD as the paper has it (section 3.3, Figure 6): patches spread over a lattice of blocked and unblocked cells, and
// grow thicker where they are supported.
//
// Bottom level. A covered cell takes each principal neighbour after an exponential waiting time of rate `spread`
// (unblocked neighbour) or `blockedSpread` (blocked). Waiting times are keyed by the link, so the moment at which a
// cell is covered is a shortest path from the seeds: one answer, found by Dijkstra's algorithm, for all of time at
// once. Seed patches come into it in order of time, each only if its place is still free.
//
// Upper levels. At each tick of its Poisson clock a covered cell rises from level l to l + 1 with probability
// `thickening` times the fraction of its supporters (itself and its four neighbours) that have reached level l.

#include "operators/growth/growth_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace patina {

namespace {

constexpr float never = std::numeric_limits<float>::infinity();

struct Step {
    float time;
    std::uint32_t cell;
    bool seed;
    bool operator>(const Step& other) const {
        return time != other.time ? time > other.time : cell != other.cell ? cell > other.cell : seed > other.seed;
    }
};

/// The cells of a square seed patch of `side` cells in the tangent plane of a cell, found by walking along links.
class PatchShape {
  public:
    PatchShape(const GrowthLattice& lattice, int side) : lattice_(lattice), half_(0.5 * side * lattice.cell) {}

    const std::vector<int>& around(int seed) {
        const Imath::V3d normal(lattice_.normals[seed]);
        Imath::V3d along(0.0);
        along[(lattice_.axes[seed] + 1) % 3] = 1.0;
        along = (along - normal * (along ^ normal)).normalized();
        const Imath::V3d across = normal % along;
        cells_.assign(1, seed);
        offsets_.assign(1, Imath::V3d(0.0));
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            for (const int next : lattice_.neighbours[cells_[i]]) {
                if (next == GrowthLattice::noCell || std::find(cells_.begin(), cells_.end(), next) != cells_.end())
                    continue;
                const Imath::V3d offset = offsets_[i] + linkVector(lattice_, cells_[i], next);
                if (!inside(offset ^ along) || !inside(offset ^ across) || offset.length() > 2.0 * half_)
                    continue;
                cells_.push_back(next);
                offsets_.push_back(offset);
            }
        }
        return cells_;
    }

  private:
    /// Half open, so that an even side has that many cells on a plane.
    bool inside(double x) const {
        const double slack = 1e-3 * lattice_.cell;
        return x >= -half_ - slack && x < half_ - slack;
    }

    const GrowthLattice& lattice_;
    double half_;
    std::vector<int> cells_;
    std::vector<Imath::V3d> offsets_;
};

/// When each cell is covered, in monolayers; infinity where that is after the run's age.
std::vector<float> coverTimes(const GrowthRun& run) {
    const GrowthLattice& lattice = run.lattice;
    const GrowthOptions& options = run.options;
    const KeyedRandom blocks = run.random("blocks"), links = run.random("links"), seeds = run.random("seeds");
    const auto age = static_cast<float>(run.age);
    std::vector<float> covered(lattice.size(), never);
    std::vector<char> blocked(lattice.size());
    std::priority_queue<Step, std::vector<Step>, std::greater<Step>> queue;
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        const Imath::V3i& key = lattice.keys[i];
        blocked[i] = blocks.uniforms(0, key.x, key.y, key.z)[0] < run.blockedAt(i);
        const double share = lattice.areas[i] * run.arrivalAt(i);
        const auto u = seeds.uniforms(0, key.x, key.y, key.z);
        const double time = u[0] < options.firstSeeds * share ? 0.0 : -std::log(u[1]) / (options.seeding * share);
        if (time <= age)
            queue.push({static_cast<float>(time), static_cast<std::uint32_t>(i), true});
    }
    for (const int cell : options.seedCells)
        queue.push({0.f, static_cast<std::uint32_t>(cell), true});

    PatchShape patch(lattice, options.patch);
    while (!queue.empty()) {
        const Step step = queue.top();
        queue.pop();
        if (step.seed) {
            if (covered[step.cell] <= step.time)
                continue;
            for (const int cell : patch.around(static_cast<int>(step.cell)))
                if (step.time < covered[cell]) {
                    covered[cell] = step.time;
                    queue.push({step.time, static_cast<std::uint32_t>(cell), false});
                }
            continue;
        }
        if (step.time > covered[step.cell])
            continue;
        const Imath::V3i& key = lattice.keys[step.cell];
        const auto u = links.uniforms(0, key.x, key.y, key.z);
        for (int slot = 0; slot < 4; ++slot) {
            const int next = lattice.neighbours[step.cell][slot];
            if (next == GrowthLattice::noCell || covered[next] <= step.time)
                continue;
            const double rate = blocked[next] ? options.blockedSpread : options.spread;
            if (rate <= 0.0)
                continue;
            // A long step takes long, so that patches are as large on slanted planes as on those along the axes.
            const double length = linkVector(lattice, static_cast<int>(step.cell), next).length() / lattice.cell *
                                  linkGauge(lattice, static_cast<int>(step.cell));
            const auto time = static_cast<float>(step.time - std::log(u[slot]) * length / rate);
            if (time <= age && time < covered[next]) {
                covered[next] = time;
                queue.push({time, static_cast<std::uint32_t>(next), false});
            }
        }
    }
    return covered;
}

struct ThickeningRule {
    const std::vector<std::array<int, 4>>& neighbours;
    const std::vector<float>& covered;
    std::vector<std::int32_t>& level;
    double thickening;

    void prefetch(std::uint32_t cell) const {
        __builtin_prefetch(&neighbours[cell]);
        __builtin_prefetch(&covered[cell]);
        __builtin_prefetch(&level[cell], 1);
    }
    void operator()(std::uint32_t cell, std::uint32_t time, std::uint32_t interval) {
        const double now = interval + uniformFromWord(time);
        if (covered[cell] > now)
            return;
        const std::int32_t own = std::max(level[cell], 1);
        int supporters = 1;
        for (const int next : neighbours[cell])
            supporters += own == 1 ? covered[next] <= now : level[next] >= own;
        // The low half of the time is free to be the die: it has no say in the order of arrivals.
        if ((time & 0xffffu) < thickening * supporters * (65536.0 / 5.0))
            level[cell] = own + 1;
    }
};

} // namespace

GrownHeights growDirectedPercolation(const GrowthRun& run) {
    const std::vector<float> covered = coverTimes(run);
    if (run.progress)
        run.progress->checkpoint();
    const ArrivalClock clock(run.lattice, run.random("arrivals"), run.random("thinning"), ArrivalClock::Rate::perCell,
                             run.options.arrival);
    const auto neighbours = closedNeighbours(run.lattice);
    std::vector<std::int32_t> level(run.lattice.size(), 0);
    if (run.earlier)
        level.assign(run.earlier->height.begin(), run.earlier->height.end());
    GrownHeights grown;
    if (run.options.thickening > 0.0)
        grown.arrivals = followArrivals(clock, run.since, run.age, run.progress,
                                        ThickeningRule{neighbours, covered, level, run.options.thickening});
    grown.height.resize(run.lattice.size());
    for (std::size_t i = 0; i < level.size(); ++i) {
        if (covered[i] <= run.age)
            level[i] = std::max(level[i], 1);
        grown.height[i] = static_cast<float>(level[i]);
        grown.particles += static_cast<std::uint64_t>(level[i]);
    }
    return grown;
}

} // namespace patina
