#include "base/errors.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Diagnostic, ShowsPlaceLineCaretAndRemedy) {
    Diagnostic d;
    d.place = {"file.patina", 3, 6};
    d.message = "unknown material 'cuprit'";
    d.remedy = "did you mean 'cuprite_2'?";
    d.sourceLine = "coat cuprit 1.2;";
    EXPECT_EQ(d.text(), "file.patina:3:6: error: unknown material 'cuprit'\n"
                        "    coat cuprit 1.2;\n"
                        "         ^\n"
                        "    did you mean 'cuprite_2'?");
}

TEST(Diagnostic, TheCaretStandsUnderItsCharacterBehindTabs) {
    Diagnostic d;
    d.place = {"f", 1, 3};
    d.sourceLine = "\t\tx";
    d.severity = Diagnostic::Severity::warning;
    d.message = "m";
    EXPECT_EQ(d.text(), "f:1:3: warning: m\n    \t\tx\n    \t\t^");
}

TEST(ScriptError, HoldsAllFindingsAndExitsWith3) {
    const ScriptError error({Diagnostic{{}, {"f", 1, 1}, "a", "", ""}, Diagnostic{{}, {"f", 2, 1}, "b", "", ""}});
    EXPECT_EQ(error.code(), ExitCode::script);
    EXPECT_STREQ(error.what(), "f:1:1: error: a\nf:2:1: error: b");
}

TEST(Error, SaysPlaceMessageAndRemedy) {
    const ModelError error("cow.obj", "has no faces", "check the file");
    EXPECT_STREQ(error.what(), "cow.obj: has no faces (check the file)");
    EXPECT_EQ(static_cast<int>(error.code()), 4);
}

} // namespace
} // namespace patina
