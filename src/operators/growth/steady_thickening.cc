// ST (paper section 3.3): thickness at a few evenly spread points, interpolated, growing with time, a little noise.
//
// Points are a Poisson-disk set in model space (Euclidean distance). Each block of about a sixth of the spacing offers
// the cell with the smallest keyed number as a candidate; a candidate becomes a point when its number is the smallest
// of all undecided candidates within the spacing, in a few rounds. Nothing depends on what lies farther away than those
// rounds reach, so a piece of a model has the points of the whole.

#include "operators/growth/grow.h"
#include "operators/growth/growth_run.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace patina {

namespace {

constexpr int rounds = 6; // growthMarginCells counts on it

// Monolayers at the start are uniform in 0…4, growth is uniform in 0.7…1.3 of the rate: about a tenth of the mean as
// rms variation once interpolated. Grain is ±6 % of the thickness, uniform.
constexpr double initialMost = 4.0, rateSpread = 0.3, grain = 0.06;

struct SamplePoint {
    Imath::V3d position;
    std::uint32_t priority;
    Imath::V3i key;
    double initial;
    double rate;
};

/// Points by cubes of a given side, for finding all within that side.
class PointGrid {
  public:
    explicit PointGrid(double side) : side_(side) {}
    Imath::V3i cube(const Imath::V3d& p) const {
        return {int(std::floor(p.x / side_)), int(std::floor(p.y / side_)), int(std::floor(p.z / side_))};
    }
    void add(const Imath::V3d& p, std::uint32_t index) { cubes_[hash(cube(p))].push_back(index); }
    template <class Visit>
    void visitNear(const Imath::V3d& p, Visit&& visit) const {
        const Imath::V3i c = cube(p);
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const auto found = cubes_.find(hash(c + Imath::V3i(x, y, z)));
                    if (found != cubes_.end())
                        for (const std::uint32_t index : found->second)
                            visit(index);
                }
    }

    /// Unique within two million cubes of the origin.
    static std::uint64_t hash(const Imath::V3i& c) {
        const auto bits = [](int v) { return std::uint64_t(std::uint32_t(v)) & 0x1fffffu; };
        return bits(c.x) | bits(c.y) << 21 | bits(c.z) << 42;
    }

  private:
    double side_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cubes_;
};

bool before(const SamplePoint& a, const SamplePoint& b) {
    if (a.priority != b.priority)
        return a.priority < b.priority;
    return std::make_tuple(a.key.x, a.key.y, a.key.z) < std::make_tuple(b.key.x, b.key.y, b.key.z);
}

std::vector<SamplePoint> candidates(const GrowthRun& run, double block) {
    const KeyedRandom points = run.random("points");
    const PointGrid grid(block);
    std::unordered_map<std::uint64_t, std::uint32_t> best;
    std::vector<SamplePoint> found;
    for (std::size_t i = 0; i < run.lattice.size(); ++i) {
        SamplePoint p;
        p.position = Imath::V3d(run.lattice.centres[i]);
        p.key = run.lattice.keys[i];
        const auto words = points.words(0, p.key.x, p.key.y, p.key.z);
        p.priority = words[0];
        p.initial = initialMost * uniformFromWord(words[1]);
        p.rate = 1.0 + rateSpread * (2.0 * uniformFromWord(words[2]) - 1.0);
        const std::uint64_t cube = PointGrid::hash(grid.cube(p.position));
        const auto [place, isNew] = best.emplace(cube, static_cast<std::uint32_t>(found.size()));
        if (isNew)
            found.push_back(p);
        else if (before(p, found[place->second]))
            found[place->second] = p;
    }
    return found;
}

std::vector<SamplePoint> poissonDisk(const GrowthRun& run, double spacing) {
    const std::vector<SamplePoint> all = candidates(run, spacing / 6.0);
    PointGrid grid(spacing);
    for (std::size_t i = 0; i < all.size(); ++i)
        grid.add(all[i].position, static_cast<std::uint32_t>(i));
    enum State : char { undecided, taken, covered };
    std::vector<State> state(all.size(), undecided), next;
    for (int round = 0; round < rounds; ++round) {
        next = state;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (state[i] != undecided)
                continue;
            bool first = true, near = false;
            grid.visitNear(all[i].position, [&](std::uint32_t j) {
                if (j == i || (all[j].position - all[i].position).length() >= spacing)
                    return;
                near = near || state[j] == taken;
                first = first && !(state[j] == undecided && before(all[j], all[i]));
            });
            next[i] = near ? covered : first ? taken : undecided;
        }
        state.swap(next);
    }
    std::vector<SamplePoint> points;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (state[i] == taken)
            points.push_back(all[i]);
    // In an order of their own, so that sums over them do not depend on where a model was cut.
    std::sort(points.begin(), points.end(), before);
    return points;
}

} // namespace

std::vector<Imath::V3d> samplePoints(const GrowthLattice& lattice, const GrowthOptions& given, std::uint64_t seed,
                                     std::string_view label) {
    GrowthOptions options = given;
    options.model = GrowthModel::steadyThickening;
    std::vector<Imath::V3d> places;
    for (const SamplePoint& point : poissonDisk({lattice, options, options.age(), seed, label, nullptr, nullptr},
                                                options.pointSpacing * lattice.cell))
        places.push_back(point.position);
    return places;
}

GrownHeights growSteadyThickening(const GrowthRun& run) {
    const GrowthLattice& lattice = run.lattice;
    const double spacing = run.options.pointSpacing * lattice.cell;
    const double radius = 2.0 * spacing;
    const std::vector<SamplePoint> points = poissonDisk(run, spacing);
    PointGrid grid(radius);
    for (std::size_t i = 0; i < points.size(); ++i)
        grid.add(points[i].position, static_cast<std::uint32_t>(i));

    const KeyedRandom noise = run.random("grain");
    GrownHeights grown;
    grown.height.resize(lattice.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lattice.size(), 1024), [&](const auto& range) {
        std::vector<std::uint32_t> near;
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Imath::V3d position(lattice.centres[i]);
            near.clear();
            grid.visitNear(position, [&](std::uint32_t j) { near.push_back(j); });
            std::sort(near.begin(), near.end());
            // Smooth weights (1 - d²/R²)³ that end at twice the spacing: a maximal set leaves no place without a point.
            double weights = 0.0, initial = 0.0, rate = 0.0;
            for (const std::uint32_t j : near) {
                const double x = 1.0 - (points[j].position - position).length2() / (radius * radius);
                if (x <= 0.0)
                    continue;
                const double weight = x * x * x;
                weights += weight;
                initial += weight * points[j].initial;
                rate += weight * points[j].rate;
            }
            initial = weights > 0.0 ? initial / weights : 0.5 * initialMost;
            rate = weights > 0.0 ? rate / weights : 1.0;
            const Imath::V3i& key = lattice.keys[i];
            const double speckle = 1.0 + grain * (2.0 * noise.uniforms(0, key.x, key.y, key.z)[0] - 1.0);
            const double start = std::min(1.0, run.age); // the first monolayer brings the initial thickness
            grown.height[i] = static_cast<float>((initial * start + rate * run.age) * speckle * run.arrivalAt(i));
        }
    });
    double solid = 0.0;
    for (std::size_t i = 0; i < lattice.size(); ++i)
        solid += double(grown.height[i]) * lattice.areas[i];
    grown.particles = static_cast<std::uint64_t>(std::llround(solid));
    return grown;
}

} // namespace patina
