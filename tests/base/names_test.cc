#include "base/names.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(EditDistance, CountsEditsAndTranspositions) {
    EXPECT_EQ(editDistance("", "abc"), 3);
    EXPECT_EQ(editDistance("kitten", "sitting"), 3);
    EXPECT_EQ(editDistance("coat", "caot"), 1);
    EXPECT_EQ(editDistance("erode", "erode"), 0);
}

TEST(DidYouMean, FindsTheNearestName) {
    const std::vector<std::string> names = {"tarnish_1", "cuprite_2", "dirt"};
    EXPECT_EQ(didYouMean("cuprit", names), "did you mean 'cuprite_2'?");
    EXPECT_EQ(didYouMean("drit", names), "did you mean 'dirt'?");
    EXPECT_EQ(didYouMean("gold", names), "");
    EXPECT_EQ(didYouMean("x", {}), "");
}

} // namespace
} // namespace patina
