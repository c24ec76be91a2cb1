#include "operators/growth/grow.h"

#include "base/errors.h"
#include "operators/growth/growth_run.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

namespace patina {

namespace {

void check(bool holds, const char* what, const char* remedy) {
    if (!holds)
        throw RunError("growth", what, remedy);
}

void checkOptions(const GrowthLattice& lattice, const GrowthOptions& options) {
    check(options.total > 0.0 && options.step >= 0.0, "step or total out of range", "use 0 <= step, total > 0");
    check(options.age() < 1e6, "a pattern older than a million monolayers", "use a smaller total");
    check(options.reach >= 1 && options.reach <= 64, "reach out of range", "use 1 to 64 cells");
    check(options.patch >= 1 && options.patch <= 256, "patch out of range", "use 1 to 256 cells");
    check(options.firstSeeds >= 0.0 && options.seeding >= 0.0, "negative density of seeds", "use 0 or more");
    check(options.blockedFraction >= 0.0 && options.blockedFraction <= 1.0, "blocked fraction out of range",
          "use 0 to 1");
    check(options.spread >= 0.0 && options.blockedSpread >= 0.0, "negative rate of spread", "use 0 or more");
    check(options.thickening >= 0.0 && options.thickening <= 1.0, "thickening out of range", "use 0 to 1");
    check(options.pointSpacing >= 1.0, "sample points closer than cells", "use fewer points");
    check(options.from == Imath::V3d(0.0) || std::abs(options.from.length() - 1.0) < 1e-6,
          "a direction that is not of unit length", "normalise it");
    check(options.levelHeight > 0.0 && options.levelHeight <= 64.0, "height of a level out of range",
          "use up to 64 cells");
    const auto fits = [&](const std::vector<float>& values) {
        return values.empty() || values.size() == lattice.size();
    };
    check(fits(options.arrival) && fits(options.blocked) && fits(options.relief), "a map that does not fit the lattice",
          "give one value per cell");
    for (const int cell : options.seedCells)
        check(cell >= 0 && std::size_t(cell) < lattice.size(), "a seed cell outside the lattice", "");
}

GrownHeights runModel(const GrowthRun& run) {
    switch (run.options.model) {
    case GrowthModel::steadyThickening:
        return growSteadyThickening(run);
    case GrowthModel::randomDeposition:
        return growRandomDeposition(run);
    case GrowthModel::relaxation:
        return growRelaxation(run);
    case GrowthModel::ballisticDeposition:
        return growBallisticDeposition(run);
    case GrowthModel::directedPercolation:
        return growDirectedPercolation(run);
    case GrowthModel::barabasiStanley:
        return growBarabasiStanley(run);
    }
    return {};
}

GrowthStatistics measure(const GrowthLattice& lattice, const GrownHeights& grown) {
    GrowthStatistics statistics = measureHeights(lattice, grown.height);
    statistics.particles = grown.particles;
    statistics.arrivals = grown.arrivals;
    double area = 0.0;
    for (const float a : lattice.areas)
        area += a;
    const double envelope = statistics.mean * area;
    statistics.density = envelope > 0.0 ? (grown.solid < 0.0 ? 1.0 : grown.solid / envelope) : 0.0;
    return statistics;
}

} // namespace

std::vector<std::array<int, 4>> closedNeighbours(const GrowthLattice& lattice) {
    auto closed = lattice.neighbours;
    for (std::size_t i = 0; i < closed.size(); ++i)
        for (int& next : closed[i])
            if (next == GrowthLattice::noCell)
                next = static_cast<int>(i);
    return closed;
}

namespace {

// All that the reference plane depends on.
using ScaleKey = std::tuple<GrowthModel, double, int, int, double, double, double, double, double, double, double>;

ScaleKey scaleKey(const GrowthOptions& o) {
    return {o.model,           o.age(),  o.reach,         o.patch,      o.firstSeeds,  o.seeding,
            o.blockedFraction, o.spread, o.blockedSpread, o.thickening, o.pointSpacing};
}

} // namespace

GrowthScale expectedScale(const GrowthOptions& given) {
    GrowthOptions options = given;
    options.arrival.clear();
    options.blocked.clear();
    options.relief.clear();
    options.seedCells.clear();
    options.from = Imath::V3d(0.0);
    if (options.ofFull)
        options.step = options.total;
    const double age = options.age();
    if (options.model == GrowthModel::randomDeposition)
        return {age, std::sqrt(age)}; // heights are Poisson numbers
    // Large enough for a standard error of one or two per cent of sigma (DPD: of about 80 seeds at the start).
    int side = 256;
    if (options.model == GrowthModel::directedPercolation)
        side = 512;
    if (options.model == GrowthModel::steadyThickening)
        options.pointSpacing = std::min(options.pointSpacing, 8.0); // the statistics do not depend on the spacing
    // Series ask for the same few again and again, and a plane takes a third of a second.
    static std::mutex mutex;
    static std::map<ScaleKey, GrowthScale> known;
    const ScaleKey key = scaleKey(options);
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (const auto found = known.find(key); found != known.end())
            return found->second;
    }
    const bool periodic = options.model != GrowthModel::steadyThickening;
    const GrowthLattice plane = flatLattice(side, side, periodic);
    const GrowthRun run{plane, options, age, 0x9e3779b97f4a7c15u, "reference plane", nullptr};
    const GrowthStatistics statistics = measureHeights(plane, runModel(run).height);
    const GrowthScale scale{statistics.mean, statistics.interfaceWidth};
    const std::lock_guard<std::mutex> lock(mutex);
    known[key] = scale;
    return scale;
}

double growthMarginCells(const GrowthOptions& options) {
    // News passes from cell to cell only by events in order of time: first-passage percolation, which travels at 2.4
    // cells per monolayer along an axis. 4 per monolayer and 24 cells leave room for the luckiest chain in 1e9 cells.
    const double travel = 4.0 * options.age() + 24.0;
    switch (options.model) {
    case GrowthModel::randomDeposition:
        return 0.0;
    case GrowthModel::steadyThickening:
        return 16.0 * options.pointSpacing; // 6 rounds that look one spacing around twice, blocks, the kernel of two
    case GrowthModel::relaxation:
        return latticeMarginCells + 2.0 * options.reach * travel;
    case GrowthModel::ballisticDeposition:
        // Slanted tracks come over what stands some levels higher some cells away.
        return latticeMarginCells + travel * (options.from == Imath::V3d(0.0) ? 1.0 : 2.0);
    case GrowthModel::directedPercolation:
        return latticeMarginCells + options.patch + std::max({1.0, options.spread, options.blockedSpread}) * travel;
    default:
        return latticeMarginCells + travel;
    }
}

std::vector<float> growHeights(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                               std::string_view label, Progress* progress) {
    checkOptions(lattice, options);
    return runModel({lattice, options, options.age(), seed, label, progress}).height;
}

namespace {

GrowthPattern patternOf(const GrowthRun& run) {
    GrownHeights grown = runModel(run);
    GrowthPattern pattern;
    pattern.statistics = measure(run.lattice, grown);

    pattern.factor.resize(run.lattice.size(), 0.f);
    const double top = expectedScale(run.options).top();
    pattern.statistics.levelFactor = top > 0.0 ? 1.0 / top : 0.0;
    if (top > 0.0)
        std::transform(grown.height.begin(), grown.height.end(), pattern.factor.begin(),
                       [top](float h) { return static_cast<float>(std::clamp(h / top, 0.0, 1.0)); });
    pattern.height = std::move(grown.height);
    return pattern;
}

} // namespace

GrowthPattern grow(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                   std::string_view label, Progress* progress) {
    checkOptions(lattice, options);
    return patternOf({lattice, options, options.age(), seed, label, progress});
}

bool goesOn(const GrowthOptions& options) {
    // On slanted tracks a particle may pass below what overhangs, and a pattern of heights has no overhangs.
    const bool slanted = options.from != Imath::V3d(0.0);
    return (options.model == GrowthModel::ballisticDeposition && !slanted) ||
           options.model == GrowthModel::directedPercolation;
}

GrowthPattern growOn(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                     std::string_view label, const GrowthPattern& earlier, double earlierStep, Progress* progress) {
    if (!goesOn(options))
        return grow(lattice, options, seed, label, progress);
    checkOptions(lattice, options);
    check(earlierStep >= 0.0 && earlierStep <= options.step, "a history cannot go back", "give an earlier step");
    check(earlier.height.size() == lattice.size(), "a pattern of another lattice", "give one of the same history");
    GrowthOptions before = options;
    before.step = earlierStep;
    GrownHeights begun;
    begun.height = earlier.height;
    begun.particles = earlier.statistics.particles;
    GrowthRun run{lattice, options, options.age(), seed, label, progress};
    run.earlier = &begun;
    run.since = before.age();
    return patternOf(run);
}

GrownParticles growParticles(const GrowthLattice& lattice, const GrowthOptions& options, std::uint64_t seed,
                             std::string_view label, Progress* progress, double since) {
    checkOptions(lattice, options);
    check(options.model == GrowthModel::ballisticDeposition, "only ballistic layers are known particle by particle",
          "use BD");
    GrownParticles particles;
    particles.occupancy = LevelOccupancy(lattice.size());
    GrownHeights grown = runModel({lattice, options, options.age(), seed, label, progress, &particles.occupancy});
    if (since > 0.0) {
        GrowthOptions earlier = options;
        earlier.step = since;
        GrownHeights before = runModel({lattice, earlier, earlier.age(), seed, label, progress});
        grown.particles -= before.particles;
        grown.solid -= before.solid;
        for (std::size_t i = 0; i < grown.height.size(); ++i)
            grown.height[i] -= before.height[i];
        particles.foot = std::move(before.height);
    }
    particles.statistics = measure(lattice, grown);
    particles.height = std::move(grown.height);
    return particles;
}

} // namespace patina
