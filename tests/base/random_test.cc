#include "base/hash.h"
#include "base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace patina {
namespace {

TEST(KeyedRandom, IsAPureFunctionOfItsKeyAndCounter) {
    const KeyedRandom a(7, "soot", "BD"), b(7, "soot", "BD");
    EXPECT_EQ(a.words(3, -1, 2, 5), b.words(3, -1, 2, 5));
}

TEST(KeyedRandom, EveryPartOfTheKeyCounts) {
    const auto reference = KeyedRandom(7, "soot", "BD").words(1, 2, 3, 4);
    EXPECT_NE(reference, KeyedRandom(8, "soot", "BD").words(1, 2, 3, 4));
    EXPECT_NE(reference, KeyedRandom(7, "soo", "tBD").words(1, 2, 3, 4));
    EXPECT_NE(reference, KeyedRandom(7, "soot", "RD").words(1, 2, 3, 4));
    EXPECT_NE(reference, KeyedRandom(7, "soot", "BD").words(2, 2, 3, 4));
    EXPECT_NE(reference, KeyedRandom(7, "soot", "BD").words(1, 2, 3, 5));
}

TEST(KeyedRandom, UniformsFillTheOpenIntervalEvenly) {
    const KeyedRandom random(1, "test", "uniform");
    constexpr int n = 100000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < n; ++i)
        for (const double u : random.uniforms(0, i, 0, 0)) {
            ASSERT_GT(u, 0.0);
            ASSERT_LT(u, 1.0);
            sum += u;
            squares += u * u;
        }
    // sd of the mean of 4n uniforms is sqrt(1/12/4n) = 4.6e-4; four of them.
    EXPECT_NEAR(sum / (4 * n), 0.5, 2e-3);
    EXPECT_NEAR(squares / (4 * n), 1.0 / 3.0, 2e-3);
}

TEST(ContentHash, WordsCannotRunTogether) {
    ContentHash a, b;
    a.add("ab");
    a.add("c");
    b.add("a");
    b.add("bc");
    EXPECT_NE(a.digest(), b.digest());
    EXPECT_EQ(a.text().size(), 16u);
}

} // namespace
} // namespace patina
