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
