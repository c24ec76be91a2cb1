// `weather --render`: one view for all frames, pictures between them, a film.

#include "program.h"
#include "render/film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace patina::test {

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

Arguments tiny(const char* model, Arguments words) {
    words.insert(words.begin(), {"weather",   model, "--environment", "marine", "--years",      "1",
                                 "--frames",  "2",   "--voxels",      "32",     "--resolution", "16",
                                 "--picture", "48",  "--samples",     "4",      "--maps",       "none",
                                 "-o",        "w"});
    return words;
}

bool onPath(const char* program) {
    std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.find(':', begin), path.size());
        std::error_code ignored;
        if (fs::exists(fs::path(path.substr(begin, end - begin)) / program, ignored))
            return true;
        begin = end + 1;
    }
    return false;
}

/// Pixels that are not the white around the object.
int coveredPixels(const fs::path& file) {
    const Image image = readPng(file);
    int count = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            count += image.at(x, y)[2] < 0.9f;
    return count;
}

double brightness(const fs::path& file) {
    const Image image = readPng(file);
    double sum = 0.0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            sum += double(image.at(x, y)[1]);
    return sum / (image.width * image.height);
}

// The camera is still: a patina drawn 6000 times as thick makes the object larger in the picture, and what lies between
// lies between. (A camera that finds the object anew in each frame shows it as large in all of them.)
TEST(WeatherFilm, TheCameraIsStillAndBetweenLiesBetween) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina(tiny("sphere", {"--render", "--between", "2", "--fps", "24", "--exaggeration",
                                                      "6000", "--light", "uniform", "--no-floor", "--camera", "30,20"}),
                                      folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto picture = [&](int number) {
        return folder.path() / "w" / ("marine_000" + std::to_string(number) + ".png");
    };
    int covered = 0;
    double bright = 1.0;
    for (int number = 1; number <= 4; ++number) {
        ASSERT_TRUE(fs::exists(picture(number))) << number;
        EXPECT_GT(coveredPixels(picture(number)), covered + 10) << number;
        EXPECT_LT(brightness(picture(number)), bright - 0.01) << "copper turns brown; picture " << number;
        covered = coveredPixels(picture(number));
        bright = brightness(picture(number));
    }
    EXPECT_FALSE(fs::exists(picture(5)));
    EXPECT_EQ(readFile(picture(1)), readFile(folder.path() / "w/year_000/preview.png"));
    EXPECT_EQ(readFile(picture(4)), readFile(folder.path() / "w/year_001/preview.png"));
    if (!onPath("ffmpeg"))
        GTEST_SKIP() << "without ffmpeg there is no film";
    EXPECT_THAT(outcome.out, HasSubstr("w/marine.mp4"));
    EXPECT_EQ(readFile(folder.path() / "w/marine.mp4").substr(4, 4), "ftyp");
}

TEST(WeatherFilm, WithoutFfmpegThePicturesAreThereAndTheCommandIsSaid) {
    const TemporaryFolder folder;
    const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "";
    ::setenv("PATH", "/nonexistent", 1);
    const Outcome outcome = vdbPatina(tiny("strip", {"--render"}), folder.path());
    ::setenv("PATH", path.c_str(), 1);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("ffmpeg is not installed"));
    EXPECT_THAT(outcome.err, HasSubstr("w/marine_%04d.png"));
    EXPECT_TRUE(fs::exists(folder.path() / "w/marine_0002.png"));
    EXPECT_FALSE(fs::exists(folder.path() / "w/marine.mp4"));

    // A series that is done is filmed without being run again.
    const Outcome again = vdbPatina(tiny("strip", {"--render", "--between", "1", "--resume"}), folder.path());
    ASSERT_EQ(again.exitCode, 0) << again.err;
    EXPECT_THAT(again.err, HasSubstr("done by an earlier run"));
    EXPECT_TRUE(fs::exists(folder.path() / "w/marine_0003.png"));
}

TEST(WeatherFilm, WhatItCannotDoIsSaidBeforeYearsAreRun) {
    const TemporaryFolder folder;
    for (const Arguments& words :
         {Arguments{"--between", "2"}, Arguments{"--render", "--between", "2", "--from", "volume"},
          Arguments{"--render", "--picture", "0"}, Arguments{"--light", "moon"}, Arguments{"--render", "--fps", "0"}}) {
        Arguments line{"weather", "sphere", "--environment", "marine", "-o", "w"};
        line.insert(line.end(), words.begin(), words.end());
        EXPECT_EQ(vdbPatina(line, folder.path()).exitCode, 2) << words.back();
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

} // namespace
} // namespace patina::test
