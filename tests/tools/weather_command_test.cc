// `weather`: years in frames that go on from each other, with the scripts that make them.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sstream>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

Arguments tiny(Arguments words) {
    for (const char* word :
         {"--voxels", "48", "--resolution", "32", "--picture", "48", "--samples", "2", "--maps", "none"})
        words.emplace_back(word);
    return words;
}

json reportIn(const fs::path& folder) {
    std::ifstream in(folder / "report.json");
    return json::parse(in, nullptr, false);
}

std::string textOf(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

TEST(WeatherCommand, WritesAFrameForEachYearThatGoesOnFromTheLast) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina(
        tiny({"weather", "sphere", "--environment", "marine", "--years", "0:20:10", "-o", "w"}), folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("contact_sheet.png"));
    double before = -1.0;
    for (const char* year : {"year_000", "year_010", "year_020"}) {
        const fs::path frame = folder.path() / "w" / year;
        EXPECT_TRUE(fs::exists(frame / "marine.vdb")) << year;
        EXPECT_TRUE(fs::exists(frame / "preview.png")) << year;
        const json report = reportIn(frame);
        ASSERT_TRUE(report.is_object()) << year;
        double sum = 0.0;
        for (const json& layer : report["layers"])
            sum += layer["mean_um"].get<double>();
        EXPECT_GT(sum, before) << "the patina grows over the first twenty years";
        before = sum;
    }
    for (const char* picture : {"marine_0001.png", "marine_0002.png", "marine_0003.png", "contact_sheet.png"})
        EXPECT_TRUE(fs::exists(folder.path() / "w" / picture)) << picture;
    EXPECT_THAT(textOf(folder.path() / "w/year_020/marine.patina"), HasSubstr("open \"../year_010/marine.vdb\""));

    // The script of a frame is an ordinary script: by hand it makes the same volume.
    const Outcome again = vdbPatina({"run", "w/year_010/marine.patina", "sphere", "-o", "w/again", "--voxels", "48",
                                     "--resolution", "32", "--picture", "0"},
                                    folder.path());
    ASSERT_EQ(again.exitCode, 0) << again.err;
    EXPECT_EQ(contentHashIn(again.out), reportIn(folder.path() / "w/year_010")["content_hash"]);
}

// A category's range, as two series.
TEST(WeatherCommand, ExtremesOfACategoryAreTwoSeries) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina(tiny({"weather", "sphere", "--environment", "rural", "--category", "C3",
                                            "--extremes", "--years", "10", "--frames", "1", "-o", "w"}),
                                      folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto thickness = [&](const char* series) {
        double sum = 0.0;
        const json report = reportIn(folder.path() / "w" / series / "year_010");
        for (const json& layer : report["layers"])
            sum += layer["mean_um"].get<double>();
        return sum;
    };
    EXPECT_GT(thickness("most"), 1.2 * thickness("least"));
}

TEST(WeatherCommand, DryRunPrintsTheScriptsAndWritesNothing) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina({"weather", "sphere", "--environment", "urban", "--years", "30", "--frames", "3",
                                       "--latitude", "60", "--dry-run"},
                                      folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("exposure(latitude=60)"));
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(WeatherCommand, WhatItCannotDoIsACommandLineError) {
    const TemporaryFolder folder;
    const std::vector<std::pair<Arguments, std::string>> wrong = {
        {{"--latitude", "91"}, "beyond the poles"},
        {{"--years", "0"}, "is not a time"},
        {{"--years", "0:10:-5"}, "is not a time"},
        {{"--years", "5:1:1"}, "'5:1:1' runs backwards: year 1 comes before year 5"},
        {{"--category", "C9"}, "C9"},
        {{"--extremes"}, "only a category has a range"},
        {{"--metal", "gold"}, "--metal"},
    };
    for (const auto& [words, message] : wrong) {
        Arguments line = {"weather", "sphere", "--environment", "marine", "-o", "w"};
        line.insert(line.end(), words.begin(), words.end());
        const Outcome outcome = vdbPatina(line, folder.path());
        EXPECT_EQ(outcome.exitCode, 2) << words[0];
        EXPECT_THAT(outcome.err, HasSubstr(message));
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

} // namespace
} // namespace patina::test
