#include "base/errors.h"
#include "growth_test_shapes.h"
#include "operators/growth/grow.h"
#include "operators/growth/growth_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

MapPoint up(double x, double y) {
    MapPoint p;
    p.position = {x, y, 0.0};
    p.normal = {0, 0, 1};
    return p;
}

TEST(GrowthMap, givesCellsTheirValuesAndIsBilinearBetween) {
    const GrowthLattice plane = flatLattice(32, 32, false, 0.5);
    GrowthOptions options;
    options.step = options.total = 5;
    const auto factor = grow(plane, options, 1, "map").factor;
    const GrowthMap map(plane, factor);
    for (int y = 1; y < 31; ++y)
        for (int x = 1; x < 31; ++x)
            ASSERT_NEAR(map.value(up((x + 0.5) * 0.5, (y + 0.5) * 0.5)), factor[y * 32 + x], 1e-5);
    const double expected = 0.75 * (0.5 * factor[5 * 32 + 7] + 0.5 * factor[5 * 32 + 8]) +
                            0.25 * (0.5 * factor[6 * 32 + 7] + 0.5 * factor[6 * 32 + 8]);
    EXPECT_NEAR(map.value(up(4.0, 2.75 + 0.125)), expected, 1e-5);
}

TEST(GrowthMap, keepsAConstantAndStaysWithinTheValuesOnCurvedSurfaces) {
    const SurfaceMesh ball = test::sphere(1.0, 30);
    const GrowthLattice lattice = surfaceLattice(ball, 0.03);
    const GrowthMap constant(lattice, std::vector<float>(lattice.size(), 0.7f));
    std::vector<float> ramp;
    for (const auto& c : lattice.centres)
        ramp.push_back(0.5f + 0.3f * c.x - 0.2f * c.z);
    const GrowthMap linear(lattice, ramp);
    for (std::size_t t = 0; t < ball.triangles.size(); t += 7) {
        const Imath::V3i& c = ball.triangles[t];
        MapPoint p;
        p.position = Imath::V3d(ball.positions[c.x] + ball.positions[c.y] + ball.positions[c.z]) / 3.0;
        p.normal = p.position.normalized();
        EXPECT_NEAR(constant.value(p), 0.7, 1e-6);
        EXPECT_NEAR(linear.value(p), 0.5 + 0.3 * p.position.x - 0.2 * p.position.z, 0.015); // half a cell times slope
    }
}

TEST(GrowthMap, aWiderFilterGivesBlockMeans) {
    const GrowthLattice plane = flatLattice(256, 256, false);
    GrowthOptions options;
    options.step = options.total = 4;
    const auto factor = grow(plane, options, 1, "map").factor;
    double mean = 0.0;
    for (const float f : factor)
        mean += f / double(factor.size());
    const GrowthMap fine(plane, factor), coarse(plane, factor, 16.0);
    double fineVariance = 0.0, coarseVariance = 0.0, coarseMean = 0.0;
    int n = 0;
    for (double y = 20; y < 236; y += 4.3)
        for (double x = 20; x < 236; x += 4.3, ++n) {
            fineVariance += std::pow(fine.value(up(x, y)) - mean, 2);
            coarseVariance += std::pow(coarse.value(up(x, y)) - mean, 2);
            coarseMean += coarse.value(up(x, y));
        }
    EXPECT_NEAR(coarseMean / n, mean, 0.005);
    // Uncorrelated cells: a tent of half width R keeps (2/3R)² of the variance, bilinear interpolation (2/3)² of it.
    EXPECT_NEAR(std::sqrt(coarseVariance / fineVariance), 1.0 / 16.0, 0.02);
}

TEST(GrowthMap, isContinuousAcrossSeams) {
    const SurfaceMesh ball = test::sphere(1.0, 60);
    const GrowthLattice lattice = surfaceLattice(ball, 0.02);
    std::vector<float> ripple;
    for (const auto& c : lattice.centres)
        ripple.push_back(0.5f + 0.5f * std::sin(20.f * c.x) * std::cos(17.f * c.y));
    const GrowthMap map(lattice, ripple);
    double last = -1.0;
    for (double angle = 0.0; angle < 6.283; angle += 0.0005) { // through six seams
        MapPoint p;
        p.normal = Imath::V3d(std::cos(angle), 0.3, std::sin(angle)).normalized();
        p.position = p.normal;
        const double value = map.value(p);
        if (last >= 0.0) {
            ASSERT_LT(std::abs(value - last), 0.06) << "at angle " << angle; // the ripple itself changes by 0.01
        }
        last = value;
    }
}

TEST(GrowthMap, aPointWithoutCellsNearbyTakesTheNearestOrNothing) {
    const GrowthLattice plane = flatLattice(8, 8, false);
    const GrowthMap map(plane, std::vector<float>(64, 0.4f));
    EXPECT_NEAR(map.value(up(-2.0, 4.0)), 0.4, 1e-6);
    EXPECT_EQ(map.value(up(-50.0, 4.0)), 0.0);
    EXPECT_EQ(map.value(up(std::nan(""), 1e300)), 0.0);
    EXPECT_EQ(GrowthMap(GrowthLattice{}, {}).value(up(0, 0)), 0.0);
    EXPECT_THROW(GrowthMap(plane, {1.f}), RunError);
}

} // namespace
} // namespace patina
