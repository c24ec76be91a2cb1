#include "operators/maps/noise_map.h"

#include "base/errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

MapPoint at(double x, double y, double z) {
    MapPoint p;
    p.position = {x, y, z};
    p.normal = {0, 0, 1};
    return p;
}

TEST(Noise, isHalfOnItsLatticeAndOnTheMean) {
    const NoiseMap noise(2.0, 1, "noise");
    double sum = 0.0, least = 1.0, most = 0.0;
    int n = 0;
    for (int i = -20; i < 20; ++i)
        for (int j = -20; j < 20; ++j)
            for (int k = -20; k < 20; ++k, ++n) {
                EXPECT_DOUBLE_EQ(noise.value(at(2.0 * i, 2.0 * j, 2.0 * k)), 0.5);
                const double v = noise.value(at(2.0 * i + 0.83, 2.0 * j + 1.21, 2.0 * k + 0.57));
                sum += v;
                least = std::min(least, v);
                most = std::max(most, v);
            }
    EXPECT_NEAR(sum / n, 0.5, 0.01);
    EXPECT_GE(least, 0.0);
    EXPECT_LE(most, 1.0);
    EXPECT_LT(least, 0.2);
    EXPECT_GT(most, 0.8);
}

TEST(Noise, isSmooth) {
    const GradientNoise noise(1, "noise");
    // Value, slope and curvature are continuous: across a lattice plane as well as between planes.
    constexpr double h = 1e-3;
    for (int i = 0; i < 20000; ++i) {
        const Imath::V3d p(i * h - 5.0, 0.37, -0.71);
        const double a = noise.at(p), b = noise.at(p + Imath::V3d(h, 0, 0)), c = noise.at(p + Imath::V3d(2 * h, 0, 0));
        ASSERT_LT(std::abs(b - a), 4.0 * h);
        ASSERT_LT(std::abs(c - 2.0 * b + a), 30.0 * h * h);
    }
}

TEST(Noise, isAFieldOfItsOwnForEachSeedAndLabel) {
    const GradientNoise a(1, "x"), b(1, "x"), c(2, "x"), d(1, "y");
    double ac = 0.0, ad = 0.0, aa = 0.0;
    for (int i = 0; i < 5000; ++i) {
        const Imath::V3d p(i * 0.731, i * 0.377, i * 0.119);
        EXPECT_EQ(a.at(p), b.at(p));
        aa += a.at(p) * a.at(p);
        ac += a.at(p) * c.at(p);
        ad += a.at(p) * d.at(p);
    }
    EXPECT_LT(std::abs(ac / aa), 0.1);
    EXPECT_LT(std::abs(ad / aa), 0.1);
}

TEST(Noise, sizeIsTheScaleOfItsFeatures) {
    const NoiseMap small(1.0, 1, "x"), large(10.0, 1, "x");
    for (int i = 0; i < 100; ++i)
        EXPECT_NEAR(small.value(at(i * 0.37, 0.2, 0.9)), large.value(at(i * 3.7, 2.0, 9.0)), 1e-12);
}

TEST(Turbulence, addsOctavesWithinRange) {
    for (const int octaves : {1, 4, 8}) {
        const TurbulenceMap map(1.0, octaves, 1, "t");
        double sum = 0.0;
        for (int i = 0; i < 20000; ++i) {
            const double v = map.value(at(i * 0.173, i * 0.071, i * 0.037));
            ASSERT_GE(v, 0.0);
            ASSERT_LE(v, 1.0);
            sum += v / 20000;
        }
        EXPECT_NEAR(sum, 0.2, 0.08);
    }
    // One octave is |noise|, the same field as noise() of that key.
    const TurbulenceMap one(1.0, 1, 1, "t");
    const GradientNoise noise(1, "t");
    EXPECT_DOUBLE_EQ(one.value(at(0.3, 0.6, 0.2)), std::abs(noise.at({0.3, 0.6, 0.2})));
}

TEST(Noise, refusesWhatMakesNoSense) {
    EXPECT_THROW(NoiseMap(0.0, 1, "x"), RunError);
    EXPECT_THROW(TurbulenceMap(1.0, 0, 1, "x"), RunError);
    EXPECT_THROW(TurbulenceMap(-1.0, 3, 1, "x"), RunError);
}

} // namespace
} // namespace patina
