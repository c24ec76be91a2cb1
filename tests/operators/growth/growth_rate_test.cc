#include "operators/growth/growth_options.h"
#include "operators/growth/growth_rate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

TEST(GrowthRate, followsItsClosedForm) {
    EXPECT_DOUBLE_EQ(growthAge(GrowthRate::linear, 5, 40), 5.0);
    EXPECT_DOUBLE_EQ(growthAge(GrowthRate::parabolic, 10, 40), 20.0);
    EXPECT_NEAR(growthAge(GrowthRate::cubic, 5, 40), 20.0, 1e-12);
    EXPECT_NEAR(growthAge(GrowthRate::logarithmic, 1, 9), 9.0 * std::log(2.0) / std::log(10.0), 1e-12);
    for (const GrowthRate rate :
         {GrowthRate::linear, GrowthRate::parabolic, GrowthRate::cubic, GrowthRate::logarithmic}) {
        EXPECT_DOUBLE_EQ(growthFraction(rate, 0.0), 0.0);
        EXPECT_NEAR(growthFraction(rate, 1.0), 1.0, 1e-15);
        EXPECT_DOUBLE_EQ(growthFraction(rate, 2.0), growthFraction(rate, 1.0));
        EXPECT_LT(growthFraction(rate, 0.3), growthFraction(rate, 0.4));
    }
    EXPECT_DOUBLE_EQ(growthAge(GrowthRate::linear, 5, 0), 0.0);
}

TEST(GrowthNames, areThoseOfTheLanguage) {
    for (const std::string& name : growthModelNames()) {
        ASSERT_TRUE(growthModelNamed(name));
        EXPECT_EQ(growthModelName(*growthModelNamed(name)), name);
    }
    EXPECT_EQ(growthModelNames().size(), 6u);
    EXPECT_FALSE(growthModelNamed("bd"));
    for (const std::string& name : growthRateNames())
        EXPECT_TRUE(growthRateNamed(name));
    EXPECT_FALSE(growthRateNamed("square"));
}

} // namespace
} // namespace patina
