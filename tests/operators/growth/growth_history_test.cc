// One history: the same on any number of threads, and every step contains the earlier ones.

#include "operators/growth/grow.h"

#include "base/errors.h"
#include "growth_test_shapes.h"
#include "support/on_threads.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

constexpr GrowthModel allModels[] = {GrowthModel::steadyThickening,    GrowthModel::randomDeposition,
                                     GrowthModel::relaxation,          GrowthModel::ballisticDeposition,
                                     GrowthModel::directedPercolation, GrowthModel::barabasiStanley};

GrowthOptions at(GrowthModel model, double step, double total) {
    GrowthOptions options;
    options.model = model;
    options.step = step;
    options.total = total;
    options.pointSpacing = 12;
    return options;
}

TEST(GrowthHistory, bitsDoNotDependOnThreads) {
    const GrowthLattice lattice = surfaceLattice(test::sphere(1.0, 20), 0.02);
    for (const GrowthModel model : allModels) {
        GrowthOptions options = at(model, 5.37, 20);
        for (std::size_t i = 0; i < lattice.size(); ++i)
            options.arrival.push_back(0.5f + 0.5f * lattice.normals[i].z);
        std::vector<float> first;
        for (const std::size_t threads : {1, 2, 4})
            test::onThreads(threads, [&] {
                const GrowthLattice again = surfaceLattice(test::sphere(1.0, 20), 0.02);
                EXPECT_EQ(again.neighbours, lattice.neighbours);
                const auto height = growHeights(lattice, options, 7, "threads");
                if (first.empty())
                    first = height;
                EXPECT_EQ(height, first) << growthModelName(model) << ", " << threads << " threads";
            });
    }
}

TEST(GrowthHistory, laterStepsContainEarlierOnes) {
    const GrowthLattice lattice = surfaceLattice(test::sphere(1.0, 20), 0.02);
    for (const GrowthModel model : allModels) {
        std::vector<float> last(lattice.size(), 0.f);
        for (const double step : {0.0, 0.4, 1.0, 2.3, 2.7, 5.0, 10.0}) {
            const auto height = growHeights(lattice, at(model, step, 20), 7, "steps");
            for (std::size_t i = 0; i < height.size(); ++i)
                ASSERT_GE(height[i], last[i]) << growthModelName(model) << " at step " << step << ", cell " << i;
            last = height;
        }
    }
}

TEST(GrowthHistory, goesOnFromAnEarlierStepForTheWorkOfTheRest) {
    const GrowthLattice lattice = surfaceLattice(test::sphere(1.0, 20), 0.02);
    for (const GrowthModel model : allModels)
        for (const auto& [from, to] : {std::pair(2.3, 5.0), std::pair(2.3, 2.7), std::pair(5.0, 10.0), std::pair(4.0, 4.0)}) {
            const GrowthPattern earlier = grow(lattice, at(model, from, 20), 7, "on");
            const GrowthPattern direct = grow(lattice, at(model, to, 20), 7, "on");
            const GrowthPattern later = growOn(lattice, at(model, to, 20), 7, "on", earlier, from);
            EXPECT_EQ(later.height, direct.height) << growthModelName(model) << ", " << from << " to " << to;
            EXPECT_EQ(later.factor, direct.factor);
            EXPECT_EQ(later.statistics.particles, direct.statistics.particles);
            EXPECT_EQ(later.statistics.density, direct.statistics.density);
            if (model == GrowthModel::ballisticDeposition || model == GrowthModel::directedPercolation) {
                EXPECT_EQ(earlier.statistics.arrivals + later.statistics.arrivals, direct.statistics.arrivals);
            }
        }
    const GrowthPattern five = grow(lattice, at(GrowthModel::ballisticDeposition, 5, 20), 7, "on");
    EXPECT_THROW(growOn(lattice, at(GrowthModel::ballisticDeposition, 4, 20), 7, "on", five, 5), RunError);
}

TEST(GrowthHistory, depositsOfAnEarlierStepAreThoseOfTheLater) {
    // Between steps 5 and 5.01 a hundredth of the cells see a particle; were it another history, most would differ.
    const GrowthLattice plane = flatLattice(128, 128, true);
    for (const GrowthModel model : allModels) {
        if (model == GrowthModel::steadyThickening)
            continue;
        const auto a = growHeights(plane, at(model, 5, 20), 7, "steps"),
                   b = growHeights(plane, at(model, 5.01, 20), 7, "steps");
        std::size_t changed = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            changed += a[i] != b[i];
        EXPECT_LT(double(changed) / double(a.size()), 0.015) << growthModelName(model);
    }
}

TEST(GrowthHistory, whatHasGrownSinceAStepIsTheRestOfIt) {
    const GrowthLattice lattice = surfaceLattice(test::sphere(1.0, 20), 0.02);
    const GrowthOptions options = at(GrowthModel::ballisticDeposition, 10, 20);
    const auto all = growParticles(lattice, options, 7, "since");
    const auto early = growParticles(lattice, at(GrowthModel::ballisticDeposition, 4, 20), 7, "since");
    const auto late = growParticles(lattice, options, 7, "since", nullptr, 4.0);
    EXPECT_EQ(early.statistics.particles + late.statistics.particles, all.statistics.particles);
    EXPECT_GT(early.statistics.particles, 3 * lattice.size());
    EXPECT_EQ(late.foot, early.height);
    for (std::size_t i = 0; i < lattice.size(); ++i) {
        ASSERT_EQ(early.height[i] + late.height[i], all.height[i]);
        for (int level = 1; level <= int(all.height[i]); ++level)
            ASSERT_EQ(all.occupancy.holds(i, level),
                      level <= int(early.height[i]) ? early.occupancy.holds(i, level)
                                                    : late.occupancy.holds(i, level));
    }
}

TEST(GrowthHistory, particlesSeeTheReliefThatIsThere) {
    // A trench six levels deep and a cell wide along a plate.
    const GrowthLattice plane = flatLattice(64, 64, true);
    const auto inTrench = [](std::size_t i) { return i % 64 == 20; };
    for (const GrowthModel model : {GrowthModel::relaxation, GrowthModel::ballisticDeposition}) {
        GrowthOptions options = at(model, 4, 20);
        const auto flat = growHeights(plane, options, 3, "relief");
        options.relief.assign(plane.size(), 2.5f);
        EXPECT_EQ(growHeights(plane, options, 3, "relief").size(), flat.size());
        if (model == GrowthModel::ballisticDeposition) {
            EXPECT_EQ(growHeights(plane, options, 3, "relief"), flat); // an even layer is no relief
        }
        for (std::size_t i = 0; i < plane.size(); ++i)
            options.relief[i] = inTrench(i) ? 0.f : 6.f;
        const auto grown = growHeights(plane, options, 3, "relief");
        double trench = 0.0, beside = 0.0, far = 0.0;
        for (std::size_t i = 0; i < plane.size(); ++i) {
            trench += inTrench(i) ? grown[i] / 64.0 : 0.0;
            beside += i % 64 == 19 || i % 64 == 21 ? grown[i] / 128.0 : 0.0;
            far += i % 64 == 50 ? grown[i] / 64.0 : 0.0;
        }
        if (model == GrowthModel::relaxation) {
            // It is filled up to its sides, which give what they would have kept.
            EXPECT_NEAR(trench - 6.0, beside, 1.0);
            EXPECT_LT(beside, far - 0.5);
        } else {
            // What falls in sticks to the walls and hangs over: level with its sides, most of it pores.
            EXPECT_NEAR(trench - 6.0, beside, 1.0);
        }
    }
}

TEST(GrowthHistory, isNamedBySeedAndLabel) {
    const GrowthLattice plane = flatLattice(64, 64, true);
    for (const GrowthModel model : allModels) {
        const auto options = at(model, 5, 20);
        const auto height = growHeights(plane, options, 1, "a");
        EXPECT_EQ(height, growHeights(plane, options, 1, "a"));
        EXPECT_NE(height, growHeights(plane, options, 2, "a")) << growthModelName(model);
        EXPECT_NE(height, growHeights(plane, options, 1, "b")) << growthModelName(model);
    }
}

TEST(GrowthHistory, moreArrivalKeepsEveryParticleOfLess) {
    const GrowthLattice plane = flatLattice(128, 128, true);
    GrowthOptions options = at(GrowthModel::randomDeposition, 8.5, 20);
    std::vector<float> last(plane.size(), 0.f);
    for (const float arrival : {0.f, 0.25f, 0.5f, 1.f}) {
        options.arrival.assign(plane.size(), arrival);
        const auto height = growHeights(plane, options, 1, "arrival");
        EXPECT_NEAR(measureHeights(plane, height).mean, 8.5 * arrival, 0.12);
        for (std::size_t i = 0; i < height.size(); ++i)
            ASSERT_GE(height[i], last[i]);
        last = height;
    }
    options.arrival.clear();
    EXPECT_EQ(last, growHeights(plane, options, 1, "arrival"));
}

TEST(GrowthHistory, arrivalShapesEveryModel) {
    // Nothing lands on one half.
    const GrowthLattice plane = flatLattice(128, 128, false);
    for (const GrowthModel model : allModels) {
        GrowthOptions options = at(model, 10, 20);
        for (std::size_t i = 0; i < plane.size(); ++i)
            options.arrival.push_back(i < plane.size() / 2 ? 0.f : 1.f);
        const auto height = growHeights(plane, options, 1, "half");
        double dry = 0.0, wet = 0.0;
        for (std::size_t i = 0; i < height.size(); ++i)
            (i < plane.size() / 2 ? dry : wet) += height[i];
        EXPECT_LT(dry, 0.6 * wet) << growthModelName(model);
    }
}

TEST(GrowthHistory, refusesWhatMakesNoSense) {
    const GrowthLattice plane = flatLattice(8, 8, true);
    GrowthOptions options = at(GrowthModel::relaxation, 1, 0);
    EXPECT_THROW(growHeights(plane, options, 1, "x"), RunError);
    options.total = 2;
    options.reach = 0;
    EXPECT_THROW(growHeights(plane, options, 1, "x"), RunError);
    options.reach = 1;
    options.arrival.assign(3, 1.f);
    EXPECT_THROW(growHeights(plane, options, 1, "x"), RunError);
    options.arrival.clear();
    options.seedCells = {64};
    EXPECT_THROW(growHeights(plane, options, 1, "x"), RunError);
    options.seedCells.clear();
    Progress progress;
    progress.cancel();
    EXPECT_THROW(growHeights(plane, options, 1, "x", &progress), Interrupted);
    EXPECT_TRUE(grow(GrowthLattice{}, options, 1, "x").factor.empty());
}

} // namespace
} // namespace patina
