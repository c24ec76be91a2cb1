// Close-ups from the command line.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

// The sphere of `make` stands on the origin.
const Arguments closeUp = {"--region-at", "0,0,0,0.0005", "--voxels", "32", "--resolution", "64", "--picture", "0"};

Arguments with(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(Region, IsATrueScaleVolumeThatOtherCommandsTake) {
    const TemporaryFolder folder;
    folder.file("films.patina", "new copper\ncoat tarnish_1 0.35\ncoat cuprite_2 1.2\n");
    const Outcome run = vdbPatina(with({"run", "films.patina", "sphere", "-o", "out"}, closeUp), folder.path());
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const json report = json::parse(readFile(folder.path() / "out/report.json"));
    EXPECT_NEAR(report["inputs"]["voxel_size_um"].get<double>(), 500.0 / 32.0, 1e-6);
    EXPECT_NEAR(report["inputs"]["voxel_size_units"].get<double>(), 0.0005 / 32.0, 1e-12);
    EXPECT_NEAR(report["layers"][0]["mean_um"].get<double>(), 0.35, 0.35 * 0.005);
    EXPECT_NEAR(report["layers"][1]["mean_um"].get<double>(), 1.2, 1.2 * 0.005);
    EXPECT_NEAR(report["surface"]["area_m2"].get<double>(), 0.0005 * 0.0005, 0.02 * 0.0005 * 0.0005);
    // Displacement is in the model's units.
    EXPECT_NEAR(report["maps"]["max_displacement_units"].get<double>(), 1.55e-6, 0.03e-6);

    const Outcome info = vdbPatina({"info", "out/films.vdb"}, folder.path());
    EXPECT_THAT(info.out, HasSubstr("a region: -0.00025,-0.00025,-0.00025 to 0.00025,0.00025,0.00025"));
    // With the whole model given again, and with the piece beside the volume.
    for (const Arguments& model : {Arguments{"sphere"}, Arguments{}}) {
        Arguments line = with({"probe", "out/films.vdb"}, model);
        const Outcome probe = vdbPatina(with(line, {"--at", "0.0001,0,0.0001", "--csv"}), folder.path());
        ASSERT_EQ(probe.exitCode, 0) << probe.err;
        const double x = std::stod(probe.out.substr(probe.out.find('\n') + 1));
        EXPECT_NEAR(x, 0.0001, 1e-6) << "in the model's coordinates: " << probe.out;
    }
    EXPECT_EQ(vdbPatina({"bake", "out/films.vdb", "sphere", "--resolution", "64", "-o", "baked"}, folder.path()).exitCode,
              0);
    const Outcome other = vdbPatina({"bake", "out/films.vdb", "strip", "--resolution", "64", "-o", "x"}, folder.path());
    EXPECT_NE(other.exitCode, 0);
}

TEST(Region, MayBeGoneOnFrom) {
    const TemporaryFolder folder;
    folder.file("first.patina", "new copper\ncoat tarnish_1 0.35\n");
    folder.file("second.patina", "open \"first/first.vdb\"\ncoat soot 1\n");
    folder.file("both.patina", "new copper\ncoat tarnish_1 0.35\ncoat soot 1\n");
    ASSERT_EQ(vdbPatina(with({"run", "first.patina", "sphere"}, closeUp), folder.path()).exitCode, 0);
    ASSERT_EQ(vdbPatina(with({"run", "both.patina", "sphere"}, closeUp), folder.path()).exitCode, 0);
    const Outcome second =
        vdbPatina({"run", "second.patina", "sphere", "--resolution", "64", "--picture", "0"}, folder.path());
    ASSERT_EQ(second.exitCode, 0) << second.err;
    EXPECT_EQ(json::parse(readFile(folder.path() / "second/report.json"))["content_hash"],
              json::parse(readFile(folder.path() / "both/report.json"))["content_hash"]);
}

TEST(Region, ErrorsSayWhatToDo) {
    const TemporaryFolder folder;
    folder.file("bare.patina", "new copper\n");
    const auto outcomes = vdbPatinaEach({{"run", "bare.patina", "sphere", "--region-at", "0.5,0.5,0.5,0.001"},
                                         {"run", "bare.patina", "sphere", "--region", "0,0,0,1,1"},
                                         {"run", "bare.patina", "sphere", "--region", "0,0,0,1,1,0"},
                                         {"run", "bare.patina", "sphere", "--region-at", "0,0,0,-1"},
                                         {"run", "bare.patina", "sphere", "--region-at", "0,0,0,nan"},
                                         {"run", "bare.patina", "sphere", "--context", "whole.vdb"},
                                         {"run", "bare.patina", "sphere", "--region-at", "0,0,0,0.001", "--voxel-size",
                                          "0.01"}},
                                        folder.path());
    const char* says[] = {"nearest to its middle", "is not 6 numbers", "no volume", "a size of", "is not 4 numbers",
                          "there is no --region",  "would be"};
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        EXPECT_EQ(outcomes[i].exitCode, 2) << i << outcomes[i].err;
        EXPECT_THAT(outcomes[i].err, HasSubstr(says[i])) << i;
    }
}

} // namespace

} // namespace patina::test
