// `slice`: the core sample of a volume.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

namespace patina::test {

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Slice : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        ball = std::make_unique<TemporaryFolder>();
        ball->file("ball.patina", "new copper\ncoat tarnish_1 0.35\ncoat soot 1\n");
        made = vdbPatina({"run", "ball.patina", "sphere", "--voxels", "48", "--resolution", "32", "--picture", "0"},
                         ball->path());
    }
    static void TearDownTestSuite() { ball.reset(); }
    void SetUp() override { ASSERT_EQ(made.exitCode, 0) << made.err; }

    static Outcome slice(Arguments words) {
        words.insert(words.begin(), {"slice", "ball/ball.vdb"});
        return vdbPatina(words, ball->path());
    }

    inline static std::unique_ptr<TemporaryFolder> ball;
    inline static Outcome made;
};

TEST_F(Slice, DrawsTheStackUnrolledAndInPlace) {
    for (const Arguments& how :
         {Arguments{}, Arguments{"--by-id"}, Arguments{"--in-place"}, Arguments{"--stretch", "2000"}}) {
        Arguments words = {"-o", "s"};
        words.insert(words.end(), how.begin(), how.end());
        const Outcome outcome = slice(words);
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr(".png"));
    }
}

TEST_F(Slice, PlacesWithoutMetalAndWrongLengthsAreErrors) {
    const Outcome away = slice({"--at", "5,5,5", "-o", "away"});
    EXPECT_NE(away.exitCode, 0);
    EXPECT_THAT(away.err, HasSubstr("there is no metal near"));
    EXPECT_FALSE(fs::exists(ball->path() / "away/slice.png"));
    EXPECT_EQ(slice({"--at", "0,0"}).exitCode, 2);
    EXPECT_EQ(slice({"--width", "3 yards"}).exitCode, 2);
    EXPECT_EQ(slice({"--width", "-3"}).exitCode, 2);
    EXPECT_EQ(slice({"--along", "0,0,0"}).exitCode, 2);
}

} // namespace
} // namespace patina::test
