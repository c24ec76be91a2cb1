// What fails while running ends with exit code 1 and leaves nothing half-written.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <map>

namespace patina::test {

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

std::map<std::string, std::uintmax_t> sizesIn(const fs::path& folder) {
    std::map<std::string, std::uintmax_t> sizes;
    for (const std::string& name : filesIn(folder))
        sizes[name] = fs::file_size(folder / name);
    return sizes;
}

// Every file that is there is as long as in a run that went well.
void expectWholeFiles(const fs::path& folder, const std::map<std::string, std::uintmax_t>& whole) {
    for (const auto& [name, size] : sizesIn(folder)) {
        ASSERT_EQ(whole.count(name), 1u) << name;
        if (name != "report.json") {
            EXPECT_EQ(size, whole.at(name)) << name;
        }
    }
}

class RunFailures : public testing::Test {
  protected:
    // A pattern, so that maps are larger files than the texts beside them.
    RunFailures() { folder.file("a.patina", "new copper\ncoat tarnish_1 0.35 texture(BD.linear_1.20)\n"); }

    Outcome run(const std::string& output, Arguments more = {}) const {
        Arguments words{"run", "a.patina", "strip", "-o", output};
        words.insert(words.end(), more.begin(), more.end());
        return vdbPatina(small(words), folder.path());
    }

    std::map<std::string, std::uintmax_t> sizesOfAGoodRun() const {
        EXPECT_EQ(run("good").exitCode, 0);
        return sizesIn(folder.path() / "good");
    }

    TemporaryFolder folder;
};

TEST_F(RunFailures, AFileInTheWayOfTheOutputFolderIsOneBeforeAnythingRuns) {
    folder.file("taken", "mine");
    for (const char* output : {"taken", "taken/deeper"}) {
        const Outcome outcome = run(output);
        EXPECT_EQ(outcome.exitCode, 1);
        EXPECT_THAT(outcome.err, HasSubstr(std::string("error: ") + output));
        EXPECT_THAT(outcome.err, HasSubstr("with -o"));
        EXPECT_FALSE(outcome.saysOnError("s  new copper"));
    }
    EXPECT_EQ(readFile(folder.path() / "taken"), "mine");
}

TEST_F(RunFailures, AFolderWithoutPermissionIsOne) {
    if (::geteuid() == 0)
        GTEST_SKIP() << "root may write everywhere";
    fs::create_directory(folder.path() / "closed");
    fs::permissions(folder.path() / "closed", fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(run("closed").exitCode, 1);
    EXPECT_EQ(run("closed/deeper").exitCode, 1);
    EXPECT_TRUE(filesIn(folder.path() / "closed").empty());
}

TEST_F(RunFailures, AReportThatCannotBeWrittenIsOneBeforeAnythingRuns) {
    fs::create_directory(folder.path() / "folder");
    for (const char* report : {"nowhere/report.json", "folder"}) {
        const Outcome outcome = run("out", {"--report", report});
        EXPECT_EQ(outcome.exitCode, 1);
        EXPECT_THAT(outcome.err, HasSubstr(std::string("error: ") + fs::path(report).begin()->string()));
        EXPECT_FALSE(outcome.saysOnError("s  new copper"));
    }
}

TEST_F(RunFailures, AFullDiskLeavesNothingHalfWritten) {
    const auto whole = sizesOfAGoodRun();
    const fs::path disk = folder.path() / "disk";
    fs::create_directory(disk);
    // Full at the volume, at the maps or meshes, at the picture.
    std::uintmax_t total = 0;
    for (const auto& [name, size] : whole)
        total += size;
    for (const double share : {0.1, 0.6, 0.95}) {
        const std::string option = "size=" + std::to_string(static_cast<long>(share * static_cast<double>(total)));
        if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, option.c_str()) != 0)
            GTEST_SKIP() << "no small disk can be mounted here: " << std::strerror(errno);
        const Outcome outcome = run("disk");
        EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr("error: disk"));
        expectWholeFiles(disk, whole);
        EXPECT_EQ(filesIn(disk).count("report.json"), 0u) << "a report stands for a whole run";
        ::umount2(disk.c_str(), MNT_DETACH);
    }
}

TEST_F(RunFailures, AFileTooLargeForTheSystemLeavesNothingHalfWritten) {
    const auto whole = sizesOfAGoodRun();
    // Inherited by the program: a write beyond the limit fails as on a full disk, and needs no rights to be tried.
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
    for (const std::uintmax_t limit : {whole.at("a.vdb") / 2, whole.at("a_limit.ply") - 100}) {
        rlimit small = before;
        small.rlim_cur = limit;
        ::setrlimit(RLIMIT_FSIZE, &small);
        const Outcome outcome = run("out");
        ::setrlimit(RLIMIT_FSIZE, &before);
        EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("error: out/"));
        expectWholeFiles(folder.path() / "out", whole);
        EXPECT_EQ(filesIn(folder.path() / "out").count("report.json"), 0u);
    }
    std::signal(SIGXFSZ, oldHandler);
}

TEST_F(RunFailures, ABakeThatFailsLeavesNoMap) {
    ASSERT_EQ(run("out", {"--picture", "0"}).exitCode, 0);
    const auto whole = sizesIn(folder.path() / "out");
    // Too large for the system: the largest map, then the copy of it with mip levels.
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
    const auto expectNothing = [&](const std::uintmax_t limit, const Arguments& more) {
        rlimit small = before;
        small.rlim_cur = limit;
        ::setrlimit(RLIMIT_FSIZE, &small);
        Arguments words{"bake", "out/a.vdb", "-o", "baked", "--resolution", "64"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = vdbPatina(words, folder.path());
        ::setrlimit(RLIMIT_FSIZE, &before);
        EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr("error: baked/"));
        EXPECT_THAT(filesIn(folder.path() / "baked"), testing::IsEmpty()) << limit << outcome.err;
    };
    std::uintmax_t largest = 0;
    for (const auto& [name, size] : whole)
        if (fs::path(name).extension() == ".exr")
            largest = std::max(largest, size);
    expectNothing(largest / 2, {});
    expectNothing(largest - 1, {}); // its last byte alone
    expectNothing(largest, {"--tx"});
    std::signal(SIGXFSZ, oldHandler);

    // A disk that is full when half of the maps are written.
    const fs::path disk = folder.path() / "disk";
    fs::create_directory(disk);
    std::uintmax_t total = 0;
    for (const auto& [name, size] : whole)
        if (fs::path(name).extension() == ".exr")
            total += size;
    const std::string option = "size=" + std::to_string(total / 2);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, option.c_str()) != 0)
        return; // not allowed to here
    const Outcome outcome = vdbPatina({"bake", "out/a.vdb", "-o", "disk", "--resolution", "64"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("error: disk"));
    EXPECT_TRUE(filesIn(disk).empty());
    ::umount2(disk.c_str(), MNT_DETACH);
}

TEST_F(RunFailures, AnOlderResultSurvivesThem) {
    ASSERT_EQ(run("out").exitCode, 0);
    const std::string volume = readFile(folder.path() / "out/a.vdb");
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    rlimit small = before;
    small.rlim_cur = volume.size() / 2;
    const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &small);
    const Outcome outcome = run("out", {"--seed", "7"});
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, oldHandler);
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_EQ(readFile(folder.path() / "out/a.vdb"), volume);
}

TEST_F(RunFailures, ADamagedVolumeIsOne) {
    ASSERT_EQ(run("out").exitCode, 0);
    const std::string whole = readFile(folder.path() / "out/a.vdb");
    std::string flipped = whole;
    flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 0x10);
    folder.file("truncated.vdb", whole.substr(0, whole.size() / 2));
    folder.file("flipped.vdb", flipped);
    folder.file("empty.vdb", "");
    folder.file("text.vdb", "not a volume\n");
    folder.file("open.patina", "open \"truncated.vdb\"\ncoat soot 1\n");
    const std::vector<Arguments> lines{Arguments{"info", "truncated.vdb"},
                                       Arguments{"info", "flipped.vdb"},
                                       Arguments{"info", "empty.vdb"},
                                       Arguments{"info", "text.vdb"},
                                       Arguments{"bake", "truncated.vdb", "strip", "-o", "baked"},
                                       Arguments{"render", "flipped.vdb", "strip", "-o", "baked"},
                                       Arguments{"probe", "truncated.vdb", "strip", "--at", "0,0,0"}};
    const std::vector<Outcome> outcomes = vdbPatinaEach(lines, folder.path());
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const Outcome& outcome = outcomes[i];
        SCOPED_TRACE(testing::PrintToString(lines[i]));
        EXPECT_EQ(outcome.exitCode, 1);
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr("error: " + lines[i][1] + ": is damaged"));
    }
    EXPECT_EQ(vdbPatina(small({"run", "open.patina", "strip", "-o", "baked"}), folder.path()).exitCode, 1);
    EXPECT_FALSE(fs::exists(folder.path() / "baked"));
    EXPECT_EQ(vdbPatina({"info", "nosuch.vdb"}, folder.path()).exitCode, 1);
}

} // namespace

} // namespace patina::test
