// A script may go on from the volume of another.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Open, TwoScriptsInARowEqualOne) {
    const TemporaryFolder folder;
    const std::string first =
        "coat tarnish_1 0.35\ncoat cuprite_2 1.2 texture(BD(rate=linear, step=5, total=40, cell=2mm))\n";
    const std::string second =
        "coat soot 0.8 texture(RD(rate=linear, step=5, total=20, cell=2mm)) as first_soot\nerode 0.1\n";
    folder.file("first.patina", "new copper\n" + first);
    folder.file("second.patina", "open \"out_first/first.vdb\"\n" + second);
    folder.file("both.patina", "new copper\n" + first + second);
    for (const char* name : {"first", "both"}) {
        const Outcome outcome = vdbPatina(
            small({"run", std::string(name) + ".patina", "sphere", "-o", std::string("out_") + name}), folder.path());
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    }
    // The opened volume brings its own voxels: no option needs to be said again.
    const Outcome outcome = vdbPatina(
        {"run", "second.patina", "sphere", "-o", "out_second", "--resolution", "64", "--picture", "0"}, folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;

    const json both = json::parse(readFile(folder.path() / "out_both/report.json"));
    const json second_ = json::parse(readFile(folder.path() / "out_second/report.json"));
    EXPECT_EQ(second_["inputs"]["voxel_size_units"], both["inputs"]["voxel_size_units"]);
    ASSERT_EQ(second_["layers"].size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(second_["layers"][k]["material"], both["layers"][k]["material"]);
        // The same operations on the same grids, bit for bit in the file: only float rounding could differ, and does
        // not.
        for (const char* quantity : {"mean_um", "max_um", "coverage"})
            EXPECT_NEAR(second_["layers"][k][quantity].get<double>(), both["layers"][k][quantity].get<double>(), 1e-6)
                << quantity;
    }
    EXPECT_EQ(second_["content_hash"], both["content_hash"]);
}

TEST(Open, WithAnotherModelEndsWith4) {
    const TemporaryFolder folder;
    folder.file("first.patina", "new copper\ncoat tarnish_1 0.35\n");
    folder.file("second.patina", "open \"first/first.vdb\"\ncoat soot 1\n");
    ASSERT_EQ(vdbPatina(small({"run", "first.patina", "sphere"}), folder.path()).exitCode, 0);
    const Outcome outcome = vdbPatina(small({"run", "second.patina", "strip"}), folder.path());
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_THAT(outcome.err, HasSubstr("is not the model that"));
    EXPECT_TRUE(filesIn(folder.path() / "second").empty());
}

TEST(Open, MayWriteOverTheVolumeItCameFrom) {
    const TemporaryFolder folder;
    folder.file("statue.patina", "new copper\ncoat tarnish_1 0.35\n");
    ASSERT_EQ(vdbPatina(small({"run", "statue.patina", "sphere"}), folder.path()).exitCode, 0);
    folder.file("statue.patina", "open \"statue/statue.vdb\"\ncoat soot 1\n");
    const Outcome outcome = vdbPatina(small({"run", "statue.patina", "sphere"}), folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(vdbPatina({"info", "statue/statue.vdb"}, folder.path()).out, HasSubstr("interface_02_soot"));
}

} // namespace

} // namespace patina::test
