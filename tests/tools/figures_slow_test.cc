// `figure N` for every N there is, at a tiny size: each plan can be read, run and laid out.

#include "program.h"
#include "render/film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace patina::test {

namespace {

namespace fs = std::filesystem;

class AllFigures : public testing::TestWithParam<int> {};

std::string padded(int number) {
    return (number < 10 ? "0" : "") + std::to_string(number);
}

/// How much greener than red the picture is in its middle.
double greenness(const Image& image) {
    double sum = 0.0;
    int count = 0;
    for (int y = image.height / 3; y < image.height * 2 / 3; ++y)
        for (int x = image.width / 3; x < image.width * 2 / 3; ++x, ++count)
            sum += double(image.at(x, y)[1]) - double(image.at(x, y)[0]);
    return sum / count;
}

fs::path pictureNamed(const fs::path& folder, const std::string& start) {
    for (const std::string& name : filesIn(folder))
        if (name.rfind(start, 0) == 0 && fs::path(name).extension() == ".png")
            return folder / name;
    return {};
}

TEST_P(AllFigures, IsMade) {
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
    if (GetParam() == 8) {
        for (const std::string environment : {"marine", "rural", "urban"}) {
            const fs::path first = pictureNamed(folder.path() / "f", environment + "_00"),
                           last = pictureNamed(folder.path() / "f", environment + "_24");
            ASSERT_FALSE(first.empty() || last.empty());
            EXPECT_GT(greenness(readPng(last)), greenness(readPng(first)) + 0.03) << environment;
        }
    }
    if (GetParam() == 11) { // five ages below each other and one picture beside them
        EXPECT_GT(image.height, 5 * 25);
    }
}

INSTANTIATE_TEST_SUITE_P(Paper, AllFigures, testing::Values(2, 3, 4, 5, 6, 8, 9, 10, 11, 12));

} // namespace
} // namespace patina::test
