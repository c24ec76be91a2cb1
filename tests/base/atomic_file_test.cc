#include "base/atomic_file.h"

#include "base/errors.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>

#include <fstream>

namespace patina {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
  protected:
    std::size_t filesLeft() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
    }
    test::TemporaryFolder folder_;
};

TEST_F(AtomicFileTest, NothingIsLeftWithoutCommit) {
    {
        AtomicFile file(folder_ / "a.txt");
        std::ofstream(file.temporary()) << "half";
    }
    EXPECT_EQ(filesLeft(), 0u);
}

TEST_F(AtomicFileTest, AnOlderFileSurvivesAFailure) {
    writeTextFile(folder_ / "a.txt", "old");
    {
        AtomicFile file(folder_ / "a.txt");
        std::ofstream(file.temporary()) << "half";
    }
    EXPECT_EQ(readTextFile(folder_ / "a.txt"), "old");
}

TEST_F(AtomicFileTest, TheTemporaryNameKeepsTheExtension) {
    AtomicFile file(folder_ / "a.exr");
    EXPECT_EQ(file.temporary().extension(), ".exr");
}

TEST_F(AtomicFileTest, AMissingFolderIsNamed) {
    try {
        AtomicFile file(folder_ / "no" / "a.txt");
        FAIL();
    } catch (const RunError& error) {
        EXPECT_THAT(error.place(), testing::HasSubstr("no"));
        EXPECT_EQ(error.code(), ExitCode::failed);
    }
}

TEST_F(AtomicFileTest, AFileInTheWayOfAFolderIsAnError) {
    writeTextFile(folder_ / "file", "x");
    EXPECT_THROW(OutputFolder(folder_ / "file"), RunError);
    EXPECT_THROW(OutputFolder(folder_ / "file" / "below"), RunError);
    EXPECT_EQ(readTextFile(folder_ / "file"), "x");
}

TEST_F(AtomicFileTest, AnOutputFolderInWhichNothingIsWrittenIsGoneAgain) {
    {
        const OutputFolder output(folder_ / "new" / "deep" / "");
        EXPECT_TRUE(fs::is_directory(folder_ / "new" / "deep"));
    }
    EXPECT_FALSE(fs::exists(folder_ / "new"));
    {
        const OutputFolder output(folder_ / "new" / "deep");
        writeTextFile(folder_ / "new" / "a.txt", "x");
    }
    EXPECT_FALSE(fs::exists(folder_ / "new" / "deep"));
    EXPECT_EQ(readTextFile(folder_ / "new" / "a.txt"), "x");
    { const OutputFolder existing(folder_ / "new"); }
    fs::remove(folder_ / "new" / "a.txt");
    { const OutputFolder existing(folder_ / "new"); }
    EXPECT_TRUE(fs::is_directory(folder_ / "new")) << "it was there before";
}

TEST_F(AtomicFileTest, ReadingAFolderOrNothingIsAnError) {
    EXPECT_THROW(readTextFile(folder_.path()), RunError);
    EXPECT_THROW(readTextFile(folder_ / "nothing"), RunError);
}

} // namespace
} // namespace patina
