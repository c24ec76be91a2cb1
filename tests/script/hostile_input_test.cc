// Nothing a file can contain crashes the reader or makes it wait: it ends in a program or in a ScriptError.

#include "script_context.h"

#include "base/random.h"

#include <gmock/gmock.h>

#include <ctime>

namespace patina {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Reads a text that may be anything. Whatever is said of it must be printable and in bounds.
void readAnything(const std::string& text) {
    try {
        readScript(text);
    } catch (const ScriptError& error) {
        ASSERT_FALSE(error.diagnostics().empty());
        EXPECT_LE(error.diagnostics().size(), 101u);
        for (const Diagnostic& finding : error.diagnostics()) {
            EXPECT_FALSE(finding.message.empty());
            EXPECT_GE(finding.place.line, 0);
            EXPECT_LE(finding.sourceLine.size(), 260u);
        }
    }
}

std::string repeated(const std::string& piece, std::size_t count) {
    std::string out;
    out.reserve(piece.size() * count);
    for (std::size_t i = 0; i < count; ++i)
        out += piece;
    return out;
}

TEST(HostileInput, deepBracketsAreAnErrorNotAStackOverflow) {
    const std::string deep = "new copper\ncoat soot 1 " + repeated("(", 100000) + "1" + repeated(")", 100000);
    EXPECT_THAT(briefly(findingsOf(deep)), ElementsAre("2:113: brackets are nested more than 100 deep"));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 " + repeated("(", 100000)))[0],
                HasSubstr("brackets are nested more than 100 deep"));
    // A hundred is still read.
    const std::string allowed = "new copper\ncoat soot 1 " + repeated("(", 100) + "1" + repeated(")", 100);
    EXPECT_NO_THROW(readScript(allowed));
    const std::string calls = "new copper\ncoat soot 1 " + repeated("min(1, ", 100) + "noise(1mm" + repeated(")", 101);
    EXPECT_THAT(briefly(findingsOf(calls)), ElementsAre(HasSubstr("nested more than 100 deep")));
}

TEST(HostileInput, deepBlocksAreAnErrorNotAStackOverflow) {
    EXPECT_THAT(briefly(findingsOf("new copper\n" + repeated("repeat 1 {\n", 100000))),
                ElementsAre("18:10: blocks are nested more than 16 deep"));
}

TEST(HostileInput, longChainsAreAnErrorNotAStackOverflow) {
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1" + repeated(" + 1", 15000))),
                ElementsAre(HasSubstr("the statement is too long")));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 " + repeated("noise(1) * ", 5000) + "1")),
                ElementsAre(HasSubstr("the statement is too long")));
    EXPECT_NO_THROW(readScript("new copper\ncoat soot " + repeated("-", 10000) + "1"));
    EXPECT_NO_THROW(readScript("new copper\ncoat soot 1" + repeated(" + 1", 500)));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1" + repeated(" + 1", 100000))),
                ElementsAre("2:1: the statement is too long"));
    readAnything("new copper\nerode 1 " + repeated("as x ", 100000));
    readAnything("new copper\ncurve c = " + repeated("(1, 2) ", 100000));
}

TEST(HostileInput, letsThatDoubleEachOtherAreAnErrorNotAnEndlessWait) {
    std::string text = "new copper\nlet a0 = noise(1mm)\n";
    for (int i = 1; i < 60; ++i)
        text += fmt::format("let a{} = a{} * a{}\n", i, i - 1, i - 1);
    EXPECT_THAT(briefly(findingsOf(text))[0], HasSubstr("the expression is too large once its 'let's are put in"));
}

TEST(HostileInput, repeatsThatMultiplyAreAnErrorNotAnEndlessWait) {
    EXPECT_THAT(briefly(findingsOf("new copper\nrepeat 1000 { repeat 1000 { repeat 1000 { erode 1 } } }")),
                ElementsAre("2:43: the script comes to more than 100000 statements"));
    EXPECT_THAT(briefly(findingsOf("new copper\nrepeat 1000 { repeat 1000 { let a = 1 } }")),
                testing::Contains(HasSubstr("the script comes to more than 100000 statements")));
}

TEST(HostileInput, hugeTextsEndSoon) {
    const std::clock_t before = std::clock(); // of this process: other work on the machine does not count
    const std::size_t largest = std::size_t{4} << 20;
    const std::size_t size = largest / 8;
    EXPECT_THAT(briefly(findingsOf(repeated("x", largest + 1))),
                ElementsAre(HasSubstr("more than the 4 MiB a script can have")));
    for (const char* piece : {"x", "(", ")", "\"", "\"\n", "{", "}", ";", "#", "/", "\n", "\xFF", "(\n",
                              "coat soot (\n", "\xC2\xB5", "coat soot 1;", "erode 1 #\n", "1.", "a.b_1.2 "})
        readAnything(repeated(piece, size / std::string(piece).size()));
    // One line, twenty thousand statements: places are still found quickly.
    EXPECT_THAT(readScript("new copper;" + repeated("erode 1µm;", 20000)).statements.size(), 20001u);
    EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 60.0);
}

TEST(HostileInput, bytesThatAreNoTextAreNamed) {
    EXPECT_THAT(briefly(findingsOf(std::string("new copper\ncoat soot 1 \0 2", 27)))[0],
                HasSubstr("found a byte 0x00"));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 \x80"))[0], HasSubstr("found a byte 0x80"));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 é"))[0], HasSubstr("found 'é'"));
    EXPECT_NO_THROW(readScript("\xEF\xBB\xBFnew copper\n"));
    // A picture in place of a script.
    EXPECT_THAT(briefly(findingsOf("\x89PNG\r\n\x1A\n"))[0], HasSubstr("expected a statement, found a byte 0x89"));
}

TEST(HostileInput, fuzzedScriptsNeverCrash) {
    const std::vector<std::string> seeds = {
        "new copper;\ncoat tarnish_1 0.35 texture(BD.linear_1.20);\ncoat cuprite_2 1.2 texture(DPD.linear_5.40) * (1 - "
        "wetness);\nerode 0.5 texture(BD.linear_5.20) of full by hardness and metal;\nrender maps;\n",
        "param t = 2mm\nlet m = min(noise(1mm), turbulence(2mm, 3)) # µ\nnew copper\nrepeat 3 { coat soot t * step m "
        "as "
        "x; }\nfill dirt 40 above smooth(2mm)\npolish area 0.3 window 2 of copper\noffset wax 1mm tangent-sphere 5 "
        "global\n",
        "curve c = (0, 0) (5, 1.2) (30, 2); seed 5; open \"x.vdb\"\nconvert posnjakite to brochantite 0.6 exposure\n"
        "coat soot c(3) texture(RD(rate=linear, step=5, total=20, cell=0.3mm, from=(0,0,1), arrival=1-slope))\n",
    };
    const std::vector<std::string> tokens = {"(",          ")",
                                             "{",          "}",
                                             ";",          "\n",
                                             "\"",         "#",
                                             "//",         ",",
                                             "=",          "-",
                                             "+",          "/",
                                             "*",          ".",
                                             "_",          "1",
                                             "0",          "1e9",
                                             "1e308",      "mm",
                                             "µm",         "nm ",
                                             " of full",   " as ",
                                             " by ",       "let ",
                                             "repeat 2 {", "step",
                                             "texture(",   "BD.linear_1.20",
                                             "coat ",      "soot ",
                                             "copper",     "new ",
                                             "noise",      "tangent-sphere",
                                             "\xFF",       "\xC2"};
    const KeyedRandom random(1996, "fuzz", "script");
    for (std::uint32_t round = 0; round < 6000; ++round) {
        std::string text = seeds[round % seeds.size()];
        const std::uint32_t edits = 1 + random.words(round, 0, 0, 0)[0] % 8;
        for (std::uint32_t edit = 0; edit < edits; ++edit) {
            const auto word = random.words(round, static_cast<std::int32_t>(edit), 1, 0);
            const std::size_t at = word[0] % (text.size() + 1);
            switch (word[1] % 5) {
            case 0: // a byte
                text.insert(at, 1, static_cast<char>(word[2] & 0xFFu));
                break;
            case 1: // a token
                text.insert(at, tokens[word[2] % tokens.size()]);
                break;
            case 2: // a hole
                text.erase(at, word[2] % 12);
                break;
            case 3: // a piece again
                text.insert(at, text.substr(word[2] % (text.size() + 1), word[3] % 40));
                break;
            default: // cut off
                if (word[2] % 4 == 0)
                    text.resize(at);
            }
        }
        SCOPED_TRACE(round);
        readAnything(text);
    }
    for (std::uint32_t round = 0; round < 500; ++round) { // bytes that never were a script
        std::string text;
        for (std::int32_t i = 0; i < 64; ++i)
            for (const std::uint32_t word : random.words(round, i, 2, 0))
                text += static_cast<char>(word & 0x7Fu);
        readAnything(text);
    }
}

} // namespace
} // namespace patina
