// Ctrl-C ends with 130; what was finished is saved, and `run --resume` ends where an uninterrupted run does.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <csignal>

namespace patina::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

class Interrupting : public testing::Test {
  protected:
    Interrupting() {
        folder.file("a.patina", "new copper\n"
                                "coat tarnish_1 0.35 noise(10mm)\n"
                                "coat cuprite_2 1.2 texture(BD(rate=linear, step=10, total=40, cell=0.5mm))\n"
                                "erode 0.2 texture(BD(rate=linear, step=5, total=20, cell=2mm))\n");
    }

    Arguments run(Arguments more = {}) const {
        Arguments words{"run", "a.patina", "sphere", "-o", "out", "--progress", "json"};
        words.insert(words.end(), more.begin(), more.end());
        return small(words);
    }

    std::string uninterruptedHash() const {
        const Outcome outcome = vdbPatina(small({"run", "a.patina", "sphere", "-o", "whole"}), folder.path());
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return contentHashIn(outcome.out);
    }

    TemporaryFolder folder;
};

const std::set<std::string> interruptedFiles{"a.interrupted.json", "a.interrupted.vdb"};

TEST_F(Interrupting, AStatementGoesOnFromTheOneBefore) {
    RunningProgram program(run(), folder.path());
    ASSERT_TRUE(program.waitFor("\"stage\":\"coat cuprite_2"));
    program.signal(SIGINT);
    const Outcome stopped = program.finish();
    ASSERT_EQ(stopped.exitCode, 130) << stopped.err;
    EXPECT_EQ(stopped.out, "");
    EXPECT_THAT(
        stopped.err,
        HasSubstr("interrupted after 2 of 4 statements; what was finished is saved (the same command with --resume"));
    EXPECT_EQ(filesIn(folder.path() / "out"), interruptedFiles);

    // Other inputs are another history.
    const Outcome other = vdbPatina(run({"--resume", "--seed", "5"}), folder.path());
    EXPECT_EQ(other.exitCode, 2);
    EXPECT_THAT(other.err, HasSubstr("is of another script, model or options"));

    const Outcome resumed = vdbPatina(run({"--resume"}), folder.path());
    ASSERT_EQ(resumed.exitCode, 0) << resumed.err;
    EXPECT_THAT(resumed.err, HasSubstr("going on after 2 of 4 statements"));
    EXPECT_FALSE(resumed.saysOnError("\"stage\":\"new copper\""));
    EXPECT_EQ(contentHashIn(resumed.out), uninterruptedHash());
    EXPECT_EQ(filesIn(folder.path() / "out"), filesIn(folder.path() / "whole")) << "the saved state is gone";

    const json report = json::parse(readFile(folder.path() / "out/report.json"));
    const json whole = json::parse(readFile(folder.path() / "whole/report.json"));
    ASSERT_EQ(report["statements"].size(), 4u) << "those finished before are in the report too";
    for (std::size_t i = 1; i < 4; ++i)
        EXPECT_EQ(report["statements"][i]["stack"], whole["statements"][i]["stack"]);
}

TEST_F(Interrupting, ThePictureGoesOnFromTheFinishedVolume) {
    RunningProgram program(run({"--picture", "4000", "--samples", "4000"}), folder.path());
    ASSERT_TRUE(program.waitFor("\"stage\":\"render preview.png\""));
    program.signal(SIGTERM);
    const Outcome stopped = program.finish();
    ASSERT_EQ(stopped.exitCode, 130) << stopped.err;
    EXPECT_THAT(stopped.err, HasSubstr("interrupted after 4 of 4 statements"));
    EXPECT_EQ(filesIn(folder.path() / "out").count("a.interrupted.vdb"), 1u);
    EXPECT_EQ(filesIn(folder.path() / "out").count("preview.png"), 0u);
    const Outcome resumed = vdbPatina(run({"--resume"}), folder.path());
    ASSERT_EQ(resumed.exitCode, 0) << resumed.err;
    EXPECT_FALSE(resumed.saysOnError("\"stage\":\"coat"));
    EXPECT_EQ(contentHashIn(resumed.out), uninterruptedHash());
    EXPECT_EQ(filesIn(folder.path() / "out"), filesIn(folder.path() / "whole"));
}

TEST_F(Interrupting, BeforeTheFirstStatementIsDoneSavesNothingAndSaysSo) {
    RunningProgram program(run({"--voxels", "300"}), folder.path());
    ASSERT_TRUE(program.waitFor("\"stage\":\"new copper\""));
    program.signal(SIGINT);
    const Outcome stopped = program.finish();
    ASSERT_EQ(stopped.exitCode, 130) << stopped.err;
    if (stopped.saysOnError("interrupted after 0")) {
        EXPECT_THAT(stopped.err, HasSubstr("there was nothing to save yet"));
    }
    EXPECT_EQ(filesIn(folder.path() / "out").count("a.vdb"), 0u);
}

TEST_F(Interrupting, ASecondTimeEndsItAtOnce) {
    RunningProgram program(run({"--picture", "4000", "--samples", "4000", "--voxels", "128"}), folder.path());
    ASSERT_TRUE(program.waitFor("\"stage\":\"coat cuprite_2"));
    program.signal(SIGINT);
    // The handler has run when the signal is no longer caught; saving the volume takes far longer than this.
    ASSERT_TRUE(program.waitUntilNotCaught(SIGINT));
    program.signal(SIGINT);
    const Outcome stopped = program.finish();
    EXPECT_EQ(stopped.signal, SIGINT) << stopped.exitCode << stopped.err;
}

TEST_F(Interrupting, NothingToResumeIsAWrongCommandLine) {
    const Outcome outcome = vdbPatina(run({"--resume"}), folder.path());
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_THAT(outcome.err,
                HasSubstr("there is no interrupted run of this script in 'out' (start anew, without --resume)"));
}

TEST_F(Interrupting, ADamagedStateIsToldAndNotTrusted) {
    std::filesystem::create_directory(folder.path() / "out");
    for (const char* state : {"", "{", "[]", "{\"inputs\": 3, \"finished\": 1}"}) {
        folder.file("out/a.interrupted.json", state);
        const Outcome outcome = vdbPatina(run({"--resume"}), folder.path());
        EXPECT_EQ(outcome.exitCode, 1);
        EXPECT_THAT(outcome.err, HasSubstr("a.interrupted.json: is damaged"));
    }
}

} // namespace

} // namespace patina::test
