// A wrong script ends with exit code 3 before anything runs, every error with its place, line, caret and remedy.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::test {

namespace {

using testing::HasSubstr;

TEST(ScriptErrors, AllThreeAreToldAtOnceWithLineAndCaret) {
    const TemporaryFolder folder;
    folder.file("wrong.patina", "new copper\n"
                                "coat cuprit_2 1.2\n"
                                "coat tarnish_1 0.3 texture(BX.linear_5.40)\n"
                                "  coat soot -2\n");
    const Outcome outcome = vdbPatina(small({"run", "wrong.patina", "strip", "-o", "out"}), folder.path());
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("wrong.patina:2:6: error: unknown material 'cuprit_2'\n"
                                       "    coat cuprit_2 1.2\n"
                                       "         ^\n"
                                       "    did you mean 'cuprite_2'?"));
    EXPECT_THAT(outcome.err, HasSubstr("wrong.patina:3:28: error: unknown growth model 'BX'\n"
                                       "    coat tarnish_1 0.3 texture(BX.linear_5.40)\n"
                                       "                               ^\n"));
    EXPECT_THAT(outcome.err, HasSubstr("wrong.patina:4:13: error: "));
    EXPECT_THAT(outcome.err, HasSubstr("      coat soot -2\n                ^\n"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(ScriptErrors, AnImageThatIsNoneOrLacksTheChannelIsOne) {
    const TemporaryFolder folder;
    folder.file("text.png", "no image");
    folder.file("colours.ppm", "P3 2 1 255 0 10 20 30 40 50");
    folder.file("wrong.patina", "new copper\n"
                                "coat soot 1 texture(\"text.png\")\n"
                                "let wear = 1 - texture(\"colours.ppm\", height)\n"
                                "coat soot 1 wear\n");
    for (const Arguments& line :
         {Arguments{"check", "wrong.patina"}, small({"run", "wrong.patina", "strip", "-o", "out"})}) {
        const Outcome outcome = vdbPatina(line, folder.path());
        EXPECT_EQ(outcome.exitCode, 3);
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err,
                    HasSubstr("wrong.patina:2:21: error: the texture 'text.png' cannot be read as an image\n"
                              "    coat soot 1 texture(\"text.png\")\n"
                              "                        ^\n"));
        EXPECT_THAT(outcome.err,
                    HasSubstr("wrong.patina:3:39: error: the texture 'colours.ppm' has no channel 'height'\n"
                              "    let wear = 1 - texture(\"colours.ppm\", height)\n"
                              "                                          ^\n"
                              "    it has R, G and B"));
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
    }
}

TEST(ScriptErrors, AnImageThatEndsTooSoonEndsTheRunWith1AndItsPlace) {
    const TemporaryFolder folder;
    folder.file("short.ppm", "P6 64 64 255\nabc");
    folder.file("a.patina", "new copper\ncoat soot 1 texture(\"short.ppm\", R)\n");
    const Outcome outcome = vdbPatina(small({"run", "a.patina", "strip", "-o", "out"}), folder.path());
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_THAT(outcome.err, HasSubstr("a.patina:2:21: the texture "));
    EXPECT_THAT(outcome.err, HasSubstr("short.ppm: cannot be read"));
}

struct WrongScript {
    const char* text;
    std::vector<const char*> says;
};

TEST(ScriptErrors, NameThePlaceAndEndWith3) {
    const TemporaryFolder folder;
    const WrongScript scripts[] = {
        {"", {"error: "}},
        {"coat soot 1\n", {":1:1: error: "}},
        {"new coper\n", {"did you mean 'copper'?"}},
        {"open \"missing.vdb\"\ncoat soot 1\n", {":1:6: error: "}},
        {"new copper\ncoat soot (1\n", {":2:11: error: "}},
        {"new copper\n"
         "coat soot\n"
         "frobnicate 3\n"
         "coat soot 1 texture(BD.linar_5.40)\n"
         "coat soot 1 texture(BD.linear_50.40)\n"
         "coat soot 1 texture(\"missing.png\")\n",
         {":2:", ":3:1: error: ", ":4:", "did you mean 'linear'?", ":5:", ":6:21: error: "}},
        {"new copper\n"
         "coat soot 1 vertices(wear)\n",
         {":2:"}},
        {"new copper\n"
         "rust 3\n"
         "coat soot 1 moss(3mm)\n",
         {":2:1: error: ", ":3:13: error: "}},
    };
    std::vector<Arguments> lines;
    for (const WrongScript& script : scripts) {
        const std::string name = "wrong" + std::to_string(lines.size()) + ".patina";
        folder.file(name, script.text);
        lines.push_back(small({"run", name, "strip", "-o", "out"}));
    }
    const std::vector<Outcome> outcomes = vdbPatinaEach(lines, folder.path());
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const WrongScript& script = scripts[i];
        const Outcome& outcome = outcomes[i];
        SCOPED_TRACE(script.text);
        EXPECT_EQ(outcome.exitCode, 3);
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr(lines[i][1]));
        for (const char* words : script.says)
            EXPECT_THAT(outcome.err, HasSubstr(words));
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
    }
}

TEST(ScriptErrors, EveryOperatorOfTheLanguageRuns) {
    const TemporaryFolder folder;
    folder.file("all.patina", "new copper\n"
                              "coat soot 1 wetness\n"
                              "grow soot 0.2\n"
                              "convert soot to dirt 0.3\n"
                              "fill dirt 1.5\n"
                              "erode 0.2 by hardness\n"
                              "polish 1.4\n"
                              "offset wax 5mm\n");
    const Outcome outcome = vdbPatina(small({"run", "all.patina", "strip", "-o", "out"}), folder.path());
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "all.vdb"));
}

TEST(ScriptErrors, WarningsAreNone) {
    const TemporaryFolder folder;
    folder.file("a.patina", "param unused = 3\nnew copper\ncoat soot 1\n");
    const Outcome outcome = vdbPatina({"check", "a.patina"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "a.patina: 2 statements, no errors\n");
    EXPECT_THAT(outcome.err,
                testing::StartsWith("a.patina:1:7: warning: 'unused' is never used\n    param unused = 3\n"));
}

TEST(ScriptErrors, UnknownParameterIsOne) {
    const TemporaryFolder folder;
    folder.file("a.patina", "param years = 3\nnew copper\ncoat soot years\n");
    const Outcome wrong = vdbPatina({"check", "a.patina", "--set", "yeers=4"}, folder.path());
    EXPECT_EQ(wrong.exitCode, 3);
    EXPECT_THAT(wrong.err, HasSubstr("the script has no parameter 'yeers'"));
    EXPECT_THAT(wrong.err, HasSubstr("did you mean 'years'?"));
    EXPECT_EQ(vdbPatina({"check", "a.patina", "--set", "years=4"}, folder.path()).exitCode, 0);
}

TEST(ScriptErrors, ScriptThatCannotBeReadEndsWith1) {
    const TemporaryFolder folder;
    const Outcome missing = vdbPatina({"run", "nosuch.patina"}, folder.path());
    EXPECT_EQ(missing.exitCode, 1);
    EXPECT_THAT(missing.err, HasSubstr("error: nosuch.patina: cannot read the file"));
    const Outcome directory = vdbPatina({"run", "."}, folder.path());
    EXPECT_EQ(directory.exitCode, 1);
    EXPECT_THAT(directory.err, HasSubstr("is a folder"));
    // A picture or a mesh by mistake is no script, and says so rather than hang or crash.
    folder.file("binary.patina", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16));
    EXPECT_EQ(vdbPatina({"run", "binary.patina"}, folder.path()).exitCode, 3);
}

TEST(ScriptErrors, EveryShippedScriptIsFreeOfThem) {
    const TemporaryFolder folder;
    std::vector<Arguments> lines;
    for (const auto& entry : std::filesystem::directory_iterator(PATINA_SOURCE_DIR "/data/scripts")) {
        if (entry.path().extension() == ".patina")
            lines.push_back({"check", entry.path().string()});
    }
    EXPECT_GE(lines.size(), 3u);
    for (const Outcome& outcome : vdbPatinaEach(lines, folder.path())) {
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("statements, no errors"));
    }
}

} // namespace

} // namespace patina::test
