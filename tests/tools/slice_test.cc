// `slice`: the core sample of a volume.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <sstream>
#include <utility>

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
        EXPECT_EQ(outcome.out, "s/ball_slice.png\n");
        EXPECT_GT(fs::file_size(ball->path() / "s/ball_slice.png"), 2000u);
        fs::remove(ball->path() / "s/ball_slice.png");
    }
}

TEST_F(Slice, PlacesWithoutMetalAndWrongLengthsAreErrors) {
    const Outcome away = slice({"--at", "5,5,5", "-o", "away"});
    EXPECT_NE(away.exitCode, 0);
    EXPECT_THAT(away.err, HasSubstr("there is no metal near"));
    EXPECT_FALSE(fs::exists(ball->path() / "away/ball_slice.png"));
    EXPECT_EQ(slice({"--at", "0,0"}).exitCode, 2);
    EXPECT_EQ(slice({"--width", "3 yards"}).exitCode, 2);
    EXPECT_EQ(slice({"--width", "-3"}).exitCode, 2);
    EXPECT_EQ(slice({"--along", "0,0,0"}).exitCode, 2);
}

// The numbers of the graph are the script's: 0.35 µm of tarnish, 1 µm of soot on it.
TEST_F(Slice, GraphsTheStackAlongANormal) {
    const Outcome outcome = slice({"--graph", "--at", "0.05,0.05,0", "-o", "g", "-v"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "g/ball_slice.png\ng/ball_graph.png\n");
    EXPECT_GT(fs::file_size(ball->path() / "g/ball_graph.png"), 2000u);
    const auto spanOf = [&](const std::string& material) {
        double from = -1.0, to = -1.0;
        std::istringstream lines(outcome.err);
        for (std::string line; std::getline(lines, line);)
            if (line.find(material) != std::string::npos && line.find(" to ") != std::string::npos) {
                std::istringstream words(line.substr(line.find(material) + material.size()));
                std::string between;
                words >> from >> between >> to;
            }
        return std::pair(from, to);
    };
    const auto [tarnishFrom, tarnishTo] = spanOf("tarnish_1");
    const auto [sootFrom, sootTo] = spanOf("soot");
    EXPECT_NEAR(tarnishTo - tarnishFrom, 0.35, 0.0035);
    EXPECT_NEAR(sootTo - sootFrom, 1.0, 0.01);
    EXPECT_DOUBLE_EQ(sootFrom, tarnishTo);
}

TEST_F(Slice, OptionsThatCannotBothBeMeantAreErrors) {
    const Outcome both = slice({"--in-place", "--stretch", "10"});
    EXPECT_EQ(both.exitCode, 2);
    EXPECT_THAT(both.err, HasSubstr("--stretch"));
    const Outcome tiny = slice({"--picture", "200"});
    EXPECT_EQ(tiny.exitCode, 2);
    EXPECT_THAT(tiny.err, HasSubstr("at least 320"));
    EXPECT_EQ(slice({"--stretch", "0"}).exitCode, 2);
    EXPECT_EQ(vdbPatina({"slice", "no.vdb"}, ball->path()).exitCode, 1);
}

} // namespace
} // namespace patina::test
