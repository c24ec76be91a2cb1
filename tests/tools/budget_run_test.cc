// What `check` says a run's memory will peak at, against the peak that the run then reports.

#include "program.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <regex>

namespace patina::test {
namespace {

using nlohmann::json;

const char* const fourLayers = "new copper\n"
                               "coat tarnish_1 0.35\n"
                               "coat cuprite_2 1.2\n"
                               "coat marine_patina_3 3\n"
                               "erode 0.5\n";

// "… peak memory 213 MiB, disk …" in bytes.
double peakSaid(const std::string& text) {
    std::smatch found;
    if (!std::regex_search(text, found, std::regex("peak memory ([0-9.]+) ([KMG])iB")))
        return NAN;
    const std::string unit = found[2];
    return std::stod(found[1]) * (unit == "K" ? 1024.0 : unit == "M" ? 1048576.0 : 1073741824.0);
}

class Budget : public testing::Test {
  protected:
    void expectPeakWithin15Percent(const std::string& model, const std::string& voxels, const std::string& resolution,
                                   const std::string& regionAt = {}, const std::string& picture = "0") {
        SCOPED_TRACE(model + ", " + voxels + " voxels, maps of " + resolution + ", a picture of " + picture);
        const TemporaryFolder folder;
        folder.file("a.patina", fourLayers);
        Arguments run{"run", "a.patina",  model,   "--voxels", voxels, "--resolution", resolution, "--threads",
                      "2",   "--picture", picture, "-o",       "out",  "--samples",    "1"};
        if (!regionAt.empty())
            run.insert(run.end(), {"--region-at", regionAt});
        Arguments dry = run;
        dry.push_back("--dry-run");
        const Outcome said = vdbPatina(dry, folder.path());
        ASSERT_EQ(said.exitCode, 0) << said.err;
        const Outcome done = vdbPatina(run, folder.path());
        ASSERT_EQ(done.exitCode, 0) << done.err;
        const json report = json::parse(readFile(folder.path() / "out/report.json"));
        const double peak = report["peak_memory_bytes"];
        EXPECT_NEAR(peakSaid(said.out) / peak, 1.0, 0.15) << peakSaid(said.out) << " of " << peak;
        // Grids are no less than their leaves' values, and their peak no less than they are.
        EXPECT_GT(report["volume"]["memory_of_formula"].get<double>(), 1.0);
        EXPECT_GT(1.15 * report["volume"]["peak_of_formula"].get<double>(),
                  report["volume"]["memory_of_formula"].get<double>());
    }
};

TEST_F(Budget, OfThePeakIsWithin15PercentWhetherVolumeOrMapsAreLarge) {
    expectPeakWithin15Percent("sphere", "96", "64");
    expectPeakWithin15Percent("sphere", "64", "1024");
    expectPeakWithin15Percent("statuette", "96", "64");
}

// The whole model stays in memory beside the piece of it, and is most of the peak.
TEST_F(Budget, OfACloseUpsPeakIsWithin15Percent) {
    expectPeakWithin15Percent("statuette", "96", "64", "0,0,0,0.03");
    expectPeakWithin15Percent("sphere", "192", "64", "0,0,0,0.02");
}

// The surface cut to a pixel is most of it.
TEST_F(Budget, OfAPicturesPeakIsWithin15Percent) {
    expectPeakWithin15Percent("sphere", "96", "64", {}, "512");
    expectPeakWithin15Percent("statuette", "96", "64", {}, "640");
}

// Dicing ends at a pixel, whatever the voxels and the part of the picture that a close-up fills.
TEST_F(Budget, OfACloseUpsPictureIsWithin15PercentAtEverySize) {
    for (const char* picture : {"256", "512", "800"})
        expectPeakWithin15Percent("statuette", "96", "64", "0,0,0,0.03", picture);
    expectPeakWithin15Percent("sphere", "96", "64", "0,0,0,0.02", "512");
    expectPeakWithin15Percent("plate", "96", "64", "0,0,0,0.02", "640");
}

} // namespace
} // namespace patina::test
