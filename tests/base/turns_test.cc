#include "base/turns.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

TEST(Turns, CirclePointsAgreeWithTheStandardLibrary) {
    for (int i = -40000; i <= 40000; ++i) {
        const float turn = static_cast<float>(i) / 16384.f; // exact
        const CirclePoint point = circlePoint(turn);
        EXPECT_NEAR(point.cosine, std::cos(2.0 * M_PI * double(turn)), 2e-7) << turn;
        EXPECT_NEAR(point.sine, std::sin(2.0 * M_PI * double(turn)), 2e-7) << turn;
    }
}

TEST(Turns, AnglesOfPointsAllAround) {
    for (int i = 0; i < 50000; ++i) {
        const double angle = 2.0 * M_PI * (i + 0.37) / 50000.0 - M_PI;
        const auto x = static_cast<float>(3.0 * std::cos(angle)), y = static_cast<float>(3.0 * std::sin(angle));
        EXPECT_NEAR(turnOf(x, y), std::atan2(double(y), double(x)) / (2.0 * M_PI), 1e-7) << angle;
    }
    EXPECT_EQ(turnOf(0.f, 0.f), 0.f);
    EXPECT_EQ(turnOf(2.f, 0.f), 0.f);
    EXPECT_EQ(turnOf(0.f, 2.f), 0.25f);
    EXPECT_EQ(turnOf(0.f, -2.f), -0.25f);
    EXPECT_EQ(turnOf(-2.f, 0.f), 0.5f);
}

TEST(Turns, AnglesOfCosines) {
    for (int i = -20000; i <= 20000; ++i) {
        const float cosine = static_cast<float>(i) / 20000.f;
        EXPECT_NEAR(halfTurnsOfCosine(cosine), std::acos(double(cosine)) / M_PI, 1e-7) << cosine;
    }
    EXPECT_EQ(halfTurnsOfCosine(1.f), 0.f);
    EXPECT_EQ(halfTurnsOfCosine(1.0001f), 0.f);
    EXPECT_EQ(halfTurnsOfCosine(-1.f), 1.f);
}

} // namespace
} // namespace patina
