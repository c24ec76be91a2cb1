// `run`: the promised files, one content hash however often and on however many threads, results on stdout and the rest
// on stderr.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <sstream>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const char* const twoLayers = "new copper\n"
                              "coat tarnish_1 0.35\n"
                              "coat cuprite_2 1.2 texture(BD.linear_5.40)\n"
                              "erode 0.1\n"
                              "render maps\n";

TEST(Run, WritesExactlyThePromisedFiles) {
    const TemporaryFolder folder;
    folder.file("a.patina", twoLayers);
    const Outcome outcome = vdbPatina(small({"run", "a.patina", "strip", "-o", "out"}), folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(filesIn(folder.path() / "out"),
              (std::set<std::string>{"a.vdb", "a.obj", "a_limit.ply", "preview.png", "report.json", "displacement.exr",
                                     "a.usda", "a.mtlx",
                                     "diffuse.exr", "lobe_00_copper.exr", "lobe_01_tarnish_1.exr",
                                     "lobe_02_cuprite_2.exr", "base_color.exr", "metallic.exr", "roughness.exr",
                                     "normal.exr", "thickness_01_tarnish_1.exr", "coverage_01_tarnish_1.exr",
                                     "thickness_02_cuprite_2.exr", "coverage_02_cuprite_2.exr"}));
    EXPECT_EQ(filesIn(folder.path()), (std::set<std::string>{"a.patina", "out"}));

    const json report = json::parse(readFile(folder.path() / "out/report.json"));
    EXPECT_EQ(report["schema"], 1);
    EXPECT_EQ(report["inputs"]["model"], "strip");
    ASSERT_EQ(report["statements"].size(), 5u);
    EXPECT_EQ(report["statements"][2]["line"], 3);
    EXPECT_EQ(report["statements"][2]["text"], "coat cuprite_2 1.2 texture(BD.linear_5.40)");
    ASSERT_EQ(report["layers"].size(), 2u);
    EXPECT_EQ(report["layers"][0]["material"], "tarnish_1");
    for (const json& layer : report["layers"])
        for (const char* quantity : {"mean_um", "max_um", "coverage", "rq_um", "volume_m3"})
            EXPECT_TRUE(layer[quantity].is_number()) << quantity;
    for (const char* quantity : {"seconds", "peak_memory_bytes"})
        EXPECT_GT(report[quantity].get<double>(), 0.0);
    std::set<std::string> stages;
    for (const json& stage : report["stages"])
        stages.insert(stage["name"].get<std::string>());
    for (const char* stage : {"new copper", "erode 0.1", "write volume", "bake maps", "render preview.png"})
        EXPECT_EQ(stages.count(stage), 1u) << stage;
    EXPECT_EQ(report["content_hash"], contentHashIn(outcome.out));
    std::set<std::string> outputs{"report.json"};
    for (const json& name : report["outputs"])
        outputs.insert(name.get<std::string>());
    EXPECT_EQ(outputs, filesIn(folder.path() / "out"));
}

TEST(Run, GivesTheSameContentOnAnyNumberOfThreadsAndEveryTime) {
    const TemporaryFolder folder;
    folder.file("a.patina", "new copper\ncoat tarnish_1 0.35 noise(20mm)\n"
                            "coat cuprite_2 1.2 texture(DPD(rate=linear, step=5, total=20, cell=2mm))\n"
                            "erode 0.2 texture(RDR(rate=cubic, step=5, total=20, cell=2mm))\n");
    std::set<std::string> hashes, displacements;
    for (const char* threads : {"1", "2", "2"}) {
        const Outcome outcome =
            vdbPatina(small({"run", "a.patina", "sphere", "-o", "out", "--threads", threads}), folder.path());
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        hashes.insert(contentHashIn(outcome.out));
        displacements.insert(readFile(folder.path() / "out/displacement.exr"));
    }
    EXPECT_EQ(hashes.size(), 1u);
    EXPECT_EQ(displacements.size(), 1u);
    const Outcome other = vdbPatina(small({"run", "a.patina", "sphere", "-o", "out", "--seed", "1"}), folder.path());
    EXPECT_EQ(hashes.count(contentHashIn(other.out)), 0u) << "another seed gives another surface";
}

TEST(Run, SaysItsResultOnStdoutAndEverythingElseOnStderr) {
    const TemporaryFolder folder;
    folder.file("a.patina", "new copper\ncoat tarnish_1 0.35\n");
    const Outcome outcome = vdbPatina(small({"run", "a.patina"}), folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.out, testing::MatchesRegex("a: 1 layers, [^\n]*content hash [0-9a-f]+\n"));
    EXPECT_THAT(outcome.err, HasSubstr("s  new copper\n"));
    EXPECT_THAT(outcome.err, HasSubstr("budget: "));
    // No bar, no colour: this is not a terminal.
    EXPECT_THAT(outcome.err, Not(HasSubstr("\r")));
    EXPECT_THAT(outcome.err, Not(HasSubstr("\x1b")));
    EXPECT_EQ(filesIn(folder.path()), (std::set<std::string>{"a", "a.patina"}))
        << "without -o the folder has the script's name";

    const Outcome quiet = vdbPatina(small({"run", "a.patina", "-q"}), folder.path());
    EXPECT_EQ(quiet.exitCode, 0);
    EXPECT_EQ(quiet.err, "");
    EXPECT_EQ(quiet.out, outcome.out);
}

TEST(Run, DrawsABarOnATerminal) {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0)
        GTEST_SKIP() << "no pseudo-terminal can be opened here";
    ::close(terminal);
    const TemporaryFolder folder;
    folder.file("a.patina", "new copper\ncoat tarnish_1 0.35\n");
    const Outcome outcome = RunningProgram(small({"run", "a.patina"}), folder.path(), true).finish();
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_THAT(outcome.err, HasSubstr("\r\x1b[K[....."));
}

TEST(Run, ProgressAsJsonIsOneObjectALine) {
    const TemporaryFolder folder;
    folder.file("a.patina", "new copper\ncoat tarnish_1 0.35\n");
    const Outcome outcome = vdbPatina(small({"run", "a.patina", "-q", "--progress", "json"}), folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    std::istringstream lines(outcome.err);
    std::set<std::string> begun, ended;
    for (std::string line; std::getline(lines, line);) {
        const json step = json::parse(line, nullptr, false);
        ASSERT_TRUE(step.is_object()) << line;
        const auto stage = step["stage"].get<std::string>();
        if (step["state"] == "begin") {
            begun.insert(stage);
        } else if (step["state"] == "end") {
            ended.insert(stage);
            EXPECT_GE(step["seconds"].get<double>(), 0.0);
        } else {
            EXPECT_EQ(step["state"], "running");
            EXPECT_GE(step["fraction"].get<double>(), 0.0);
            EXPECT_LE(step["fraction"].get<double>(), 1.0);
        }
    }
    EXPECT_EQ(begun, ended);
    EXPECT_EQ(begun.count("coat tarnish_1 0.35"), 1u);
}

TEST(Run, DryRunPrintsTheBudgetAndWritesNothing) {
    const TemporaryFolder folder;
    folder.file("a.patina", twoLayers);
    const Outcome outcome = vdbPatina({"run", "a.patina", "sphere", "--dry-run", "-o", "out"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_THAT(outcome.out, testing::MatchesRegex("budget: .* voxels in the band, .*peak memory .*\n"));
    EXPECT_EQ(filesIn(folder.path()), std::set<std::string>{"a.patina"});
}

TEST(Run, OverTheBudgetEndsWith5AndLeavesNothing) {
    const TemporaryFolder folder;
    folder.file("a.patina", twoLayers);
    const Outcome outcome =
        vdbPatina(small({"run", "a.patina", "strip", "-o", "out", "--budget", "0.001"}), folder.path());
    EXPECT_EQ(outcome.exitCode, 5);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("nothing was started (use fewer --voxels"));
    EXPECT_EQ(filesIn(folder.path()), std::set<std::string>{"a.patina"});
    // A resolution no machine holds, without a --budget of one's own.
    const Outcome fine = vdbPatina({"run", "a.patina", "sphere", "--voxels", "60000", "-o", "out"}, folder.path());
    EXPECT_EQ(fine.exitCode, 5);
    EXPECT_EQ(filesIn(folder.path()), std::set<std::string>{"a.patina"});
    // Who insists gets it.
    const Outcome forced =
        vdbPatina(small({"run", "a.patina", "strip", "-o", "out", "--budget", "0.001", "--force"}), folder.path());
    EXPECT_EQ(forced.exitCode, 0);
}

TEST(Run, SetChangesAParameterAndReportTellsIt) {
    const TemporaryFolder folder;
    folder.file("a.patina", "param thick = 1\nnew copper\ncoat tarnish_1 thick\n");
    const Outcome outcome =
        vdbPatina(small({"run", "a.patina", "sphere", "-o", "out", "--set", "thick=2um", "--report", "elsewhere.json"}),
                  folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(filesIn(folder.path() / "out").count("report.json"), 0u);
    const json report = json::parse(readFile(folder.path() / "elsewhere.json"));
    EXPECT_EQ(report["inputs"]["parameters"].size(), 1u);
    EXPECT_NEAR(report["layers"][0]["mean_um"].get<double>(), 2.0, 0.02);
}

} // namespace

} // namespace patina::test
