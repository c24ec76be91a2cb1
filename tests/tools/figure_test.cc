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
        const Outcome outcome = vdbPatina({"figure", number, "-o", "f", "--threads", "2", "--scale", "0.4"}, folder.path());
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

TEST(Figure, WhatItCannotDoIsSaidBeforeAnythingIsMade) {
    const TemporaryFolder folder;
    for (const Arguments& words : {Arguments{"figure"}, Arguments{"figure", "two"}, Arguments{"figure", "2", "--scale", "0"},
                                   Arguments{"figure", "2", "--scale", "100"}})
        EXPECT_EQ(vdbPatina(words, folder.path()).exitCode, 2) << words.back();
    EXPECT_TRUE(fs::is_empty(folder.path()));
    const Outcome missing = vdbPatina({"figure", "11", "--model", "no.obj", "-o", "f"}, folder.path());
    EXPECT_NE(missing.exitCode, 0);
    EXPECT_THAT(missing.err, HasSubstr("no.obj"));
    EXPECT_FALSE(fs::exists(folder.path() / "f/figure_11.png"));
}

} // namespace
} // namespace patina::test
