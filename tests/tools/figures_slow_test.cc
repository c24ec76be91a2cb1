// `figure N` at a tiny size, for those that take seconds: each plan can be read, run and laid out.

#include "program.h"
#include "render/film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace patina::test {

namespace {

namespace fs = std::filesystem;

class FiguresInSmall : public testing::TestWithParam<int> {};

std::string padded(int number) {
    return (number < 10 ? "0" : "") + std::to_string(number);
}

TEST_P(FiguresInSmall, IsMade) {
    const TemporaryFolder folder;
    const std::string number = std::to_string(GetParam()), name = "figure_" + padded(GetParam()) + ".png";
    const Outcome outcome = vdbPatina({"figure", number, "--scale", "0.12", "-o", "f"}, folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "f/" + name + "\n");
    const Image image = readPng(folder.path() / "f" / name);
    std::set<int> tones;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            tones.insert(int(image.at(x, y)[0] * 255.f));
    EXPECT_GT(tones.size(), 15u) << "there is more in it than paper";
}

INSTANTIATE_TEST_SUITE_P(Paper, FiguresInSmall, testing::Values(2, 3, 9));

} // namespace
} // namespace patina::test
