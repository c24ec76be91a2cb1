// `figure N` at a tiny size, all ten: each plan can be read, run and laid out, with labels and without holes.

#include "program.h"
#include "render/film.h"

#include <gmock/gmock.h>
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
    EXPECT_GT(image.width, 100);
    EXPECT_GT(image.height, 100);
    EXPECT_LT(std::max(image.width, image.height), 1000);
    EXPECT_THAT(outcome.err, testing::Not(testing::HasSubstr("no labels"))) << "tools/setup.sh installs a font";
    // In fields of a fifth of each side: most have something in them, and no column is empty and no row below the title.
    std::set<int> tones;
    int filled = 0, inRow[5] = {}, inColumn[5] = {};
    for (int field = 0; field < 25; ++field) {
        const int row = field / 5, column = field % 5;
        int least = 255, most = 0;
        for (int y = row * image.height / 5; y < (row + 1) * image.height / 5; ++y)
            for (int x = column * image.width / 5; x < (column + 1) * image.width / 5; ++x) {
                const int tone = int(image.at(x, y)[0] * 255.f);
                tones.insert(tone);
                least = std::min(least, tone), most = std::max(most, tone);
            }
        if (most - least > 25) {
            ++filled;
            ++inRow[row];
            ++inColumn[column];
        }
    }
    EXPECT_GT(tones.size(), 15u) << "there is more in it than paper";
    EXPECT_GT(filled, 15);
    for (int i = 0; i < 5; ++i) {
        EXPECT_TRUE(i == 0 || inRow[i] > 0) << "row " << i;
        EXPECT_GT(inColumn[i], 0) << "column " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Paper, FiguresInSmall, testing::Values(2, 3, 4, 5, 6, 8, 9, 10, 11, 12));

} // namespace
} // namespace patina::test
