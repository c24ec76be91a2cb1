#include "script_context.h"

#include "base/atomic_file.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace patina {
namespace {

std::filesystem::path scriptPath(const std::string& name) {
    return std::filesystem::path(PATINA_SOURCE_DIR) / "data" / "scripts" / name;
}

/// The layers of a program: material, thickness, pattern.
std::vector<std::string> stack(const Program& program) {
    std::vector<std::string> out;
    for (const Statement& statement : program.statements) {
        const auto* coat = std::get_if<Coat>(&statement.action);
        const auto* erode = std::get_if<Erode>(&statement.action);
        if (!coat && !erode)
            continue;
        const GrowthCall& growth = *(coat ? coat->map : erode->map)->growth;
        out.push_back(fmt::format("{} {} {}.{}_{}.{}", coat ? coat->material : "-",
                                  coat ? coat->thicknessUm : erode->thicknessUm, growth.model, growth.rate, growth.step,
                                  growth.total));
    }
    return out;
}

// The one growth somewhere in a map.
const GrowthCall& growthOf(const Expression& map) {
    const Expression* at = &map;
    while (at->kind != Expression::Kind::growth) {
        const auto holdsGrowth = [](const Expression& e) {
            return e.kind != Expression::Kind::number && e.kind != Expression::Kind::name;
        };
        at = &*std::find_if(at->children.begin(), at->children.end(), holdsGrowth);
    }
    return *at->growth;
}

// The part of the thickness that mix(part, 1, growth) lays everywhere.
double everywhere(const Expression& map) {
    return map.text == "mix" ? map.children.front().number : 0.0;
}

TEST(ShippedScripts, runThePapersThreeScriptsAsPrinted) {
    const auto read = [](const std::string& name) { return readProgramFile(scriptPath(name), testContext()); };
    EXPECT_THAT(stack(read("marine.patina")),
                testing::ElementsAre("tarnish_1 0.35 BD.linear_1.20", "cuprite_2 1.2 DPD.linear_5.40",
                                     "marine_patina_3 3 BD.linear_10.20", "marine_patina_4 1.8 DPD.linear_20.40",
                                     "- 0.5 BD.linear_5.20"));
    EXPECT_THAT(stack(read("rural.patina")),
                testing::ElementsAre("tarnish_1 0.25 ST.cubic_1.20", "cuprite_2 1 ST.cubic_5.20",
                                     "rural_patina_3 1 ST.cubic_10.20", "rural_patina_4 1.1 ST.cubic_15.20"));
    EXPECT_THAT(stack(read("urban.patina")),
                testing::ElementsAre("tarnish_1 0.55 RD.linear_1.40", "cuprite_urban_2 1 RD.cubic_10.40",
                                     "patina_urban_3 4 DPD.cubic_5.40", "patina_urban_4 3 DPD.cubic_10.40",
                                     "- 0.8 DPD.linear_30.40", "dirt 1.9 BD.linear_5.20"));
    for (const char* name : {"marine.patina", "rural.patina", "urban.patina"})
        EXPECT_TRUE(read(name).warnings.empty()) << name;
}

TEST(ShippedScripts, keepThePapersMissingSemicolon) {
    const std::string marine = readTextFile(scriptPath("marine.patina"));
    EXPECT_THAT(marine, testing::HasSubstr("coat marine_patina_3 3.0 texture(BD.linear_10.20)\ncoat marine_patina_4"));
}

TEST(ShippedScripts, areVerbatimInThePaper) {
    const std::filesystem::path paper = std::filesystem::path(PATINA_SOURCE_DIR) / ".." / "shared" / "paper.txt";
    if (!std::filesystem::exists(paper))
        GTEST_SKIP() << "the paper's text is not there: " << paper;
    const std::string printed = readTextFile(paper);
    for (const char* name : {"marine.patina", "rural.patina", "urban.patina"})
        EXPECT_NE(printed.find(readTextFile(scriptPath(name))), std::string::npos) << name;
}

TEST(LanguageReference, hasExamplesThatAreScripts) {
    const std::string text = readTextFile(std::filesystem::path(PATINA_SOURCE_DIR) / "docs" / "language.md");
    CheckContext context = testContext();
    context.kinetics = readKinetics(std::filesystem::path(PATINA_SOURCE_DIR) / "data");
    int examples = 0;
    std::size_t at = 0;
    while ((at = text.find("```\n", at)) != std::string::npos) {
        const std::size_t end = text.find("```", at + 4);
        ASSERT_NE(end, std::string::npos);
        const std::string block = text.substr(at + 4, end - at - 4);
        at = end + 4;
        if (block.find("\nnew copper") == std::string::npos && block.compare(0, 4, "new ") != 0)
            continue;
        ++examples;
        try {
            EXPECT_TRUE(readScript(block, context).warnings.empty()) << block;
        } catch (const ScriptError& error) {
            ADD_FAILURE() << error.what();
        }
    }
    EXPECT_EQ(examples, 3);
}

TEST(ShippedScripts, tellOneHistoryInSixSteps) {
    struct Seen {
        double thicknessUm;
        int step;
        int total;
        double everywhere;
    };
    for (const std::string environment : {"marine", "rural", "urban"}) {
        std::map<std::string, Seen> before;
        for (const char* year : {"00", "06", "12", "18", "24", "30"}) {
            const Program program =
                readProgramFile(scriptPath(fmt::format("{}_{}.patina", environment, year)), testContext());
            EXPECT_TRUE(program.warnings.empty());
            std::map<std::string, Seen> now;
            for (const Statement& statement : program.statements) {
                const auto* coat = std::get_if<Coat>(&statement.action);
                if (!coat)
                    continue;
                const GrowthCall& growth = growthOf(*coat->map);
                EXPECT_TRUE(growth.ofFull) << statement.text;
                EXPECT_EQ(growth.label, statement.label);
                now[statement.label] = {coat->thicknessUm, growth.step, growth.total, everywhere(*coat->map)};
            }
            for (const auto& [label, old] : before) {
                ASSERT_TRUE(now.count(label)) << environment << year << ": " << label;
                EXPECT_EQ(now[label].thicknessUm, old.thicknessUm) << label;
                EXPECT_EQ(now[label].total, old.total) << label;
                EXPECT_GE(now[label].step, old.step) << label;
                EXPECT_GE(now[label].everywhere, old.everywhere) << label;
            }
            before = now;
        }
    }
}

// The last frame has the materials, thicknesses and pattern ages of the paper's stack (a linear pattern's age is its
// step, a cubic one's total ∛(step / total)).
TEST(ShippedScripts, endTheirHistoriesAtThePapersStacks) {
    for (const std::string environment : {"marine", "rural", "urban"}) {
        const Program last = readProgramFile(scriptPath(environment + "_30.patina"), testContext());
        const Program paper = readProgramFile(scriptPath(environment + ".patina"), testContext());
        ASSERT_EQ(last.statements.size(), paper.statements.size());
        for (std::size_t i = 1; i + 1 < paper.statements.size(); ++i) {
            const bool isErosion = std::holds_alternative<Erode>(paper.statements[i].action);
            ASSERT_EQ(std::holds_alternative<Erode>(last.statements[i].action), isErosion);
            if (isErosion)
                continue;
            EXPECT_EQ(coatAt(last, i).material, coatAt(paper, i).material);
            EXPECT_EQ(coatAt(last, i).thicknessUm, coatAt(paper, i).thicknessUm);
            const GrowthCall &ours = growthOf(*coatAt(last, i).map), &theirs = growthOf(*coatAt(paper, i).map);
            EXPECT_EQ(ours.model, theirs.model);
            const double x = double(theirs.step) / theirs.total;
            EXPECT_NEAR(ours.step, theirs.total * (theirs.rate == "cubic" ? std::cbrt(x) : x), 0.5);
            EXPECT_EQ(ours.step, ours.total);
        }
    }
}

} // namespace
} // namespace patina
