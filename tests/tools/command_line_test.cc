// Wrong command lines end with exit code 2 and say what was meant; help reads well.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace patina::test {

namespace {

using testing::HasSubstr;
using testing::Not;

struct WrongLine {
    Arguments words;
    const char* says;
};

TEST(CommandLine, SaysWhatIsWrongAndEndsWith2) {
    const TemporaryFolder folder;
    folder.file("a.patina", "new copper\n");
    const WrongLine lines[] = {
        {{}, "a command is missing: one of run, "},
        {{"runn", "a.patina"}, "'runn' is not a command (did you mean 'run'?)"},
        {{"xyzzy"}, "'xyzzy' is not a command (one of run, "},
        {{"a.patina"}, "did you mean 'vdb-patina run a.patina'?"},
        {{"run"}, "SCRIPT is required"},
        {{"make"}, "SHAPE is required"},
        {{"make", "spere"}, "did you mean 'sphere'?"},
        {{"run", "a.patina", "strip", "again"}, "'again' is one argument too many"},
        {{"run", "a.patina", "--voxel", "3"}, "'run' has no option '--voxel' (did you mean '--voxels'?)"},
        {{"-v", "run", "a.patina"}, "option '-v' stands before the command"},
        {{"run", "a.patina", "--voxels", "many"}, "--voxels: 'many' is not a whole number from 8 to 65536"},
        {{"run", "a.patina", "--voxels", "32.5"}, "--voxels: '32.5' is not"},
        {{"run", "a.patina", "--voxels", "32", "--voxels", "64"}, "--voxels is given 2 times"},
        {{"run", "a.patina", "--voxels"}, "--voxels: its value is missing"},
        {{"run", "a.patina", "--voxel-size", "-1"}, "--voxel-size: '-1' is not a number above 0"},
        {{"run", "a.patina", "--voxel-size", "nan"}, "--voxel-size: 'nan' is not"},
        {{"run", "a.patina", "--voxels", "32", "--voxel-size", "1"}, "exclude each other"},
        {{"run", "a.patina", "--budget", "0"}, "--budget: '0' is not a number above 0"},
        {{"run", "a.patina", "--seed", "-1"}, "--seed: '-1' is not"},
        {{"run", "a.patina", "--unit", "inch"}, "--unit: 'inch' is not m, cm, mm or um"},
        {{"run", "a.patina", "--scheme", "lop"}, "did you mean 'loop'?"},
        {{"run", "a.patina", "--progress", "jsn"}, "did you mean 'json'?"},
        {{"run", "a.patina", "--azimuth", "900"}, "--azimuth: '900' is not a number from -360 to 360"},
        {{"run", "a.patina", "--set", "years"}, "--set: 'years' is not of the form NAME=VALUE"},
        {{"run", "a.patina", "--set", "a=1", "--set", "a=2"}, "'a' is set twice"},
        {{"run", "a.patina", "-v", "-q"}, "exclude each other"},
        {{"materials", "cuprit_2"}, "did you mean 'cuprite_2'?"},
    };
    std::vector<Arguments> words;
    for (const WrongLine& line : lines)
        words.push_back(line.words);
    const std::vector<Outcome> outcomes = vdbPatinaEach(words, folder.path());
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const WrongLine& line = lines[i];
        const Outcome& outcome = outcomes[i];
        SCOPED_TRACE(testing::PrintToString(line.words));
        EXPECT_EQ(outcome.exitCode, 2);
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr(line.says));
        EXPECT_THAT(outcome.err, testing::StartsWith("error: "));
    }
    EXPECT_EQ(filesIn(folder.path()), std::set<std::string>{"a.patina"});
}

TEST(CommandLine, HelpListsEveryCommandWithoutRequiredNoise) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina({"--help"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    const std::vector<std::string> commands{"run",   "bake",      "render", "probe",        "info",
                                            "check", "materials", "make",   "contact-sheet"};
    std::vector<Arguments> lines;
    for (const std::string& command : commands)
        lines.push_back({command, "--help"});
    const std::vector<Outcome> helps = vdbPatinaEach(lines, folder.path());
    for (std::size_t i = 0; i < commands.size(); ++i) {
        const std::string& command = commands[i];
        const Outcome& help = helps[i];
        EXPECT_THAT(outcome.out, HasSubstr("\n  " + command + " "));
        EXPECT_EQ(help.exitCode, 0) << command;
        EXPECT_THAT(help.out, HasSubstr("Usage: vdb-patina " + command + " [options]"));
        for (const char* noise : {"REQUIRED", "Excludes", "->", " INT", "TEXT:", "\n\n\n"})
            EXPECT_THAT(help.out, Not(HasSubstr(noise))) << command;
        std::istringstream text(help.out);
        for (std::string line; std::getline(text, line);)
            EXPECT_LE(line.size(), 130u) << line;
    }
    EXPECT_EQ(vdbPatina({"help", "run"}, folder.path()).out, helps.front().out);
}

TEST(CommandLine, HelpNamesTheOptionsOfTheManual) {
    const TemporaryFolder folder;
    const std::string help = vdbPatina({"run", "--help"}, folder.path()).out;
    for (const char* option : {"-o,", "--voxels N", "--voxel-size X", "--unit", "--exaggeration E", "--subdivide L",
                               "--resolution P", "--seed S", "--threads T", "--set NAME=VALUE", "--budget GIB",
                               "--dry-run", "--force", "-v,", "-q,", "--progress", "--report FILE", "--resume"})
        EXPECT_THAT(help, HasSubstr(option));
}

TEST(CommandLine, VersionGoesToStdout) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina({"--version"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_THAT(outcome.out, testing::MatchesRegex("vdb-patina [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

} // namespace

} // namespace patina::test
