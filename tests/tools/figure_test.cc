// `figure`: what is shipped in data/figures can be laid out.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::test {

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(Figure, ChartsAndSectionsAreLaidOut) {
    const TemporaryFolder folder;
    // Figure 2 is drawn from the weather's plans, figure 3 from a volume.
    for (const char* number : {"2", "3"}) {
        const Outcome outcome = vdbPatina({"figure", number, "-o", "f", "--threads", "2"}, folder.path());
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        const std::string file = std::string("f/figure_0") + number + ".png";
        EXPECT_THAT(outcome.out, HasSubstr(file));
        ASSERT_TRUE(fs::exists(folder.path() / file));
        EXPECT_GT(fs::file_size(folder.path() / file), 5000u) << "a picture with something in it";
    }
}

TEST(Figure, UnknownNumbersNameThoseThereAre) {
    const TemporaryFolder folder;
    const Outcome outcome = vdbPatina({"figure", "7"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_THAT(outcome.err, HasSubstr("there is no figure 7"));
    EXPECT_THAT(outcome.err, HasSubstr("2, 3, 4, "));
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

} // namespace
} // namespace patina::test
