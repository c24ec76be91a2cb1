// What a coat sees: factors by the model's own mean and deviation.

#include "operators/growth/grow.h"

#include "growth_test_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patina {
namespace {

double mean(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

GrowthOptions linear(const char* model, double step, double total) {
    GrowthOptions options;
    options.model = *growthModelNamed(model);
    options.step = step;
    options.total = total;
    return options;
}

TEST(GrowthScale, ofRandomDepositionIsClosedForm) {
    const GrowthScale scale = expectedScale(linear("RD", 9, 40));
    EXPECT_DOUBLE_EQ(scale.mean, 9.0);
    EXPECT_DOUBLE_EQ(scale.sigma, 3.0);
    EXPECT_DOUBLE_EQ(scale.top(), 18.0);
}

TEST(GrowthScale, ofTheOthersIsWhatAnyLargePlaneShows) {
    const GrowthLattice plane = flatLattice(512, 512, true);
    for (const char* model : {"ST", "RD", "RDR", "BD", "DPD", "DPD_BS"}) {
        const GrowthOptions options = linear(model, 6, 20);
        const GrowthPattern pattern = grow(plane, options, 12, "any");
        const GrowthScale scale = expectedScale(options);
        EXPECT_NEAR(pattern.statistics.mean / scale.mean, 1.0, 0.1) << model;
        if (options.model != GrowthModel::steadyThickening) { // it has only some hundred independent points here
            EXPECT_NEAR(pattern.statistics.interfaceWidth / scale.sigma, 1.0, 0.1) << model;
        }
        EXPECT_GE(*std::min_element(pattern.factor.begin(), pattern.factor.end()), 0.f);
        EXPECT_LE(*std::max_element(pattern.factor.begin(), pattern.factor.end()), 1.f);
        // Clamping beyond three sigma takes little from the mean.
        EXPECT_NEAR(mean(pattern.factor), scale.mean / scale.top(), 0.1 * scale.mean / scale.top()) << model;
    }
}

TEST(GrowthScale, doesNotDependOnTheObject) {
    const GrowthOptions options = linear("BD", 5, 20);
    const GrowthPattern small = grow(flatLattice(16, 16, true), options, 1, "x");
    const GrowthPattern large = grow(flatLattice(128, 128, true), options, 1, "x");
    const auto ratio = [](const GrowthPattern& p) {
        for (std::size_t i = 0; i < p.height.size(); ++i)
            if (p.factor[i] > 0.f && p.factor[i] < 1.f)
                return double(p.height[i]) / p.factor[i];
        return 0.0;
    };
    EXPECT_NEAR(ratio(small), ratio(large), 1e-3);
    EXPECT_NEAR(ratio(small), expectedScale(options).top(), 1e-3);
}

TEST(GrowthScale, leavesOutTheMapsThatSteerAnObject) {
    GrowthOptions options = linear("BD", 5, 20);
    const double top = expectedScale(options).top();
    options.arrival.assign(100, 0.1f);
    options.blocked.assign(100, 0.9f);
    EXPECT_EQ(expectedScale(options).top(), top);
}

TEST(GrowthScale, ofFullKeepsHeightsRelativeToTheLastStep) {
    GrowthOptions options = linear("RD", 10, 40);
    const GrowthLattice plane = flatLattice(128, 128, true);
    options.ofFull = true;
    const GrowthPattern pattern = grow(plane, options, 1, "x");
    EXPECT_NEAR(mean(pattern.factor), 10.0 / (40.0 + 3.0 * std::sqrt(40.0)), 0.002);
}

TEST(GrowthScale, stepNoughtIsBare) {
    const GrowthLattice plane = flatLattice(64, 64, true);
    for (const char* model : {"ST", "RD", "RDR", "BD", "DPD_BS"}) {
        const GrowthPattern pattern = grow(plane, linear(model, 0, 20), 1, "x");
        EXPECT_EQ(mean(pattern.factor), 0.0) << model;
        EXPECT_EQ(pattern.statistics.particles, 0u) << model;
    }
}

TEST(SteadyThickening, isSmoothAndNearlyUniform) {
    const GrowthLattice plane = flatLattice(400, 400, false);
    for (const double step : {1.0, 5.0, 15.0}) {
        GrowthOptions options = linear("ST", step, 20);
        options.rate = GrowthRate::cubic;
        const GrowthPattern pattern = grow(plane, options, 3, "ST");
        EXPECT_NEAR(pattern.statistics.interfaceWidth / pattern.statistics.mean, 0.1, 0.05);
        EXPECT_EQ(pattern.statistics.coverage, 1.0);
        // Half of the spacing apart it is alike, several spacings apart it is not.
        const auto correlation = [&](int shift) {
            double sum = 0.0;
            std::size_t n = 0;
            for (int y = 0; y < 400; ++y)
                for (int x = 0; x + shift < 400; ++x, ++n)
                    sum += (pattern.height[y * 400 + x] - pattern.statistics.mean) *
                           (pattern.height[y * 400 + x + shift] - pattern.statistics.mean);
            return sum / double(n) / std::pow(pattern.statistics.interfaceWidth, 2);
        };
        EXPECT_GT(correlation(12), 0.6);
        EXPECT_LT(std::abs(correlation(200)), 0.5);
    }
}

TEST(SteadyThickening, hasPointsASpacingApartAndEverywhere) {
    const GrowthLattice ball = surfaceLattice(test::sphere(1.0, 60), 0.01);
    GrowthOptions options = linear("ST", 1, 20);
    constexpr int asked = 150;
    const double area = 4.0 * M_PI;
    options.pointSpacing = pointSpacingFor(asked, area, ball.cell);
    const double spacing = options.pointSpacing * ball.cell;
    double count = 0.0;
    for (const std::uint64_t seed : {1, 2, 3}) {
        const auto points = samplePoints(ball, options, seed, "ST");
        count += double(points.size()) / 3.0;
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                ASSERT_GE((points[i] - points[j]).length(), spacing);
        double furthest = 0.0;
        for (std::size_t c = 0; c < ball.size(); c += 7) {
            double nearest = 10.0;
            for (const Imath::V3d& p : points)
                nearest = std::min(nearest, (p - Imath::V3d(ball.centres[c])).length());
            furthest = std::max(furthest, nearest);
        }
        RecordProperty("furthest", std::to_string(furthest / spacing));
        EXPECT_LT(furthest, 2.0 * spacing); // as far as the weights reach
    }
    RecordProperty("points", std::to_string(count));
    EXPECT_NEAR(count / asked, 1.0, 0.1);
}

TEST(SteadyThickening, hasAboutAsManyPointsAsAskedFor) {
    EXPECT_NEAR(pointSpacingFor(40, 512.0 * 171.0, 1.0), 36.8, 0.1);
    EXPECT_NEAR(pointSpacingFor(100, 1.0, 0.01), std::sqrt(0.62 / 100.0) / 0.01, 1e-9);
}

TEST(GrowthStatistics, areWeightedByArea) {
    GrowthLattice lattice = flatLattice(4, 1, false);
    lattice.areas = {1.f, 1.f, 1.f, 3.f};
    const GrowthStatistics s = measureHeights(lattice, {2.f, 0.f, 4.f, 4.f});
    EXPECT_DOUBLE_EQ(s.mean, 3.0);
    EXPECT_DOUBLE_EQ(s.coverage, 5.0 / 6.0);
    EXPECT_EQ(s.patches, 2u);
    EXPECT_NEAR(s.interfaceWidth, std::sqrt((1.0 + 9.0 + 1.0 + 3.0) / 6.0), 1e-12);
}

} // namespace
} // namespace patina
