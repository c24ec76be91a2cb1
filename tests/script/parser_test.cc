#include "script_context.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Parser, readsEveryExampleOfTheInterface) {
    const Program program = readScript(R"(new copper;                             # or: open "statue.vdb";
coat tarnish_1 0.35 texture(BD.linear_1.20);
coat cuprite_2 1.2 texture(DPD.linear_5.40) * (1 - wetness);
coat soot 0.8 texture(RD(rate=linear, step=5, total=20, cell=0.3mm, from=(0,0,1))) as first_soot;
erode 0.5 texture(BD.linear_5.20);      erode 2 accessibility(3mm) by hardness;
grow tarnish_1 0.2;                     # a buried layer thickens where it lies; what is above moves out
convert posnjakite to brochantite 0.6 exposure;
fill dirt 1.5;                          # up to 1.5 µm above the bare metal
fill dirt 40 above smooth(2mm);         # up to 40 µm above the metal smoothed by a ball of 2 mm: fills crevices
polish 2.0;   polish area 0.3;          # down to a height; until 30 % of the surface is plateau
offset wax 0.2mm;   offset wax 0.2mm tangent-sphere 5;
render maps;
)");
    ASSERT_EQ(program.statements.size(), 15u);
    EXPECT_EQ(std::get<NewMetal>(program.statements[0].action).metal, "copper");

    const Coat& tarnish = coatAt(program, 1);
    EXPECT_EQ(tarnish.material, "tarnish_1");
    EXPECT_DOUBLE_EQ(tarnish.thicknessUm, 0.35);
    ASSERT_EQ(tarnish.map->kind, Expression::Kind::growth);
    EXPECT_EQ(tarnish.map->growth->model, "BD");
    EXPECT_EQ(tarnish.map->growth->rate, "linear");
    EXPECT_EQ(tarnish.map->growth->step, 1);
    EXPECT_EQ(tarnish.map->growth->total, 20);
    EXPECT_FALSE(tarnish.map->growth->ofFull);

    const Coat& cuprite = coatAt(program, 2);
    ASSERT_EQ(cuprite.map->kind, Expression::Kind::binary);
    EXPECT_EQ(cuprite.map->text, "*");
    EXPECT_EQ(cuprite.map->children.at(1).text, "-");
    EXPECT_EQ(cuprite.map->children.at(1).children.at(1).text, "wetness");

    const Coat& soot = coatAt(program, 3);
    EXPECT_EQ(program.statements[3].label, "first_soot");
    EXPECT_DOUBLE_EQ(*soot.map->growth->cellUm, 300.0);
    EXPECT_THAT(*soot.map->growth->from, ElementsAre(0.0, 0.0, 1.0));
    EXPECT_EQ(soot.map->growth->label, "first_soot");

    EXPECT_FALSE(std::get<Erode>(program.statements[4].action).byHardness);
    const Erode& soft = std::get<Erode>(program.statements[5].action);
    EXPECT_TRUE(soft.byHardness);
    EXPECT_EQ(soft.map->text, "accessibility");
    EXPECT_DOUBLE_EQ(soft.map->children.at(0).number, 3000.0);
    EXPECT_DOUBLE_EQ(std::get<Grow>(program.statements[6].action).thicknessUm, 0.2);
    const Convert& convert = std::get<Convert>(program.statements[7].action);
    EXPECT_EQ(convert.from, "posnjakite");
    EXPECT_EQ(convert.to, "brochantite");
    EXPECT_DOUBLE_EQ(convert.fraction, 0.6);
    EXPECT_EQ(convert.map->text, "exposure");
    EXPECT_DOUBLE_EQ(std::get<Fill>(program.statements[8].action).heightUm, 1.5);
    EXPECT_DOUBLE_EQ(*std::get<Fill>(program.statements[9].action).aboveSmoothRadiusUm, 2000.0);
    EXPECT_DOUBLE_EQ(*std::get<Polish>(program.statements[10].action).heightUm, 2.0);
    EXPECT_FALSE(std::get<Polish>(program.statements[10].action).area.has_value());
    EXPECT_DOUBLE_EQ(*std::get<Polish>(program.statements[11].action).area, 0.3);
    EXPECT_DOUBLE_EQ(std::get<Offset>(program.statements[12].action).radiusUm, 200.0);
    EXPECT_DOUBLE_EQ(*std::get<Offset>(program.statements[13].action).tangentSphereThicknessUm, 5.0);
    EXPECT_EQ(std::get<Render>(program.statements[14].action).what, "maps");
    // Nothing but the posnjakite that was never laid.
    EXPECT_THAT(briefly(program.warnings), ElementsAre("7:9: there is no layer of 'posnjakite' yet: nothing happens"));
}

TEST(Parser, readsTheOtherClauses) {
    const Program program = readScript("new copper\n"
                                       "coat soot 1\n"
                                       "erode 1 and metal by hardness as wind\n"
                                       "polish area 0.2 noise(1mm) window 2mm of copper\n"
                                       "offset wax 1mm global\n"
                                       "grow soot 1 noise(1mm) as more everywhere\n");
    const Erode& erode = std::get<Erode>(program.statements[2].action);
    EXPECT_TRUE(erode.andMetal);
    EXPECT_TRUE(erode.byHardness);
    EXPECT_EQ(program.statements[2].label, "wind");
    const Polish& polish = std::get<Polish>(program.statements[3].action);
    EXPECT_DOUBLE_EQ(*polish.windowUm, 2000.0);
    EXPECT_EQ(polish.ofMaterial, "copper");
    EXPECT_EQ(polish.map->text, "noise");
    EXPECT_TRUE(std::get<Offset>(program.statements[4].action).global);
    EXPECT_TRUE(std::get<Grow>(program.statements[5].action).everywhere);
    EXPECT_EQ(program.statements[5].label, "more");
}

TEST(Parser, endsAStatementAtItsLineButNotInsideBrackets) {
    const Program program = readScript("new copper\r\n"
                                       "coat soot 1 clamp(  # the map goes on\n"
                                       "    noise(1mm), // here\n"
                                       "    0, 1)\n"
                                       "coat dirt 2; coat wax 3");
    ASSERT_EQ(program.statements.size(), 4u);
    EXPECT_EQ(program.statements[1].text, "coat soot 1 clamp( noise(1mm), 0, 1)");
    EXPECT_EQ(program.statements[3].place.text(), "test.patina:5:14");
}

TEST(Parser, takesEveryUnitAndReadsABareNumberAsMicrometres) {
    const char* lines[] = {"1000nm", "1um", "1 µm", "1 μm", "0.001mm", "0.0001 cm", "1e-6m", "1", "1.", "10 * .1"};
    for (const char* line : lines) {
        const Program program = readScript(std::string("new copper\ncoat soot ") + line);
        EXPECT_NEAR(coatAt(program, 1).thicknessUm, 1.0, 1e-15) << line;
    }
}

TEST(Parser, readsTheShortFormOfAGrowthPatternAsTheLongOne) {
    const Program program = readScript("new copper\n"
                                       "coat soot 1 texture(DPD_BS.logarithmic_007.040) as a\n"
                                       "coat soot 1 texture(DPD_BS(rate=logarithmic, step=7, total=40)) as a\n"
                                       "coat soot 1 texture(BD.linear_1.20) as a\n");
    const GrowthCall& shortForm = *coatAt(program, 1).map->growth;
    const GrowthCall& longForm = *coatAt(program, 2).map->growth;
    EXPECT_EQ(shortForm.model, longForm.model);
    EXPECT_EQ(shortForm.rate, longForm.rate);
    EXPECT_EQ(shortForm.step, longForm.step);
    EXPECT_EQ(shortForm.total, longForm.total);
    EXPECT_EQ(shortForm.label, longForm.label);
    EXPECT_EQ(shortForm.ofFull, longForm.ofFull);
    EXPECT_FALSE(shortForm.cellUm || shortForm.arrival || shortForm.from || shortForm.reachUm || shortForm.blocked);
    EXPECT_EQ(shortForm.step, 7);
    // Step and total are two integers: 1.20 is not 1.2.
    EXPECT_EQ(coatAt(program, 3).map->growth->total, 20);
}

TEST(Parser, takesOfFullInsideAndBehindTheTexture) {
    const Program program = readScript("new copper\n"
                                       "coat soot 1 texture(BD.linear_1.20 of full)\n"
                                       "coat soot 1 0.5 * texture(BD.linear_1.20) of full * noise(1mm)\n"
                                       "polish area 0.5 texture(BD.linear_1.20) of full of soot\n");
    EXPECT_TRUE(coatAt(program, 1).map->growth->ofFull);
    EXPECT_TRUE(coatAt(program, 2).map->children.at(0).children.at(1).growth->ofFull);
    EXPECT_TRUE(std::get<Polish>(program.statements[3].action).map->growth->ofFull);
    EXPECT_EQ(std::get<Polish>(program.statements[3].action).ofMaterial, "soot");
}

TEST(Parser, readsEveryArgumentOfGrowth) {
    const Program program =
        readScript("new copper\n"
                   "coat soot 1 texture(RDR(rate=cubic, step=1, total=2, cell=50, arrival=1 - exposure, from=(3, 0, "
                   "4), reach=1mm))\n"
                   "coat soot 1 texture(DPD(rate=cubic, step=1, total=2, blocked=wetness, patch=12, seeding=1e-4))\n"
                   "coat soot 1 texture(ST(rate=parabolic, step=1, total=2, points=300))\n"
                   "coat soot 1 texture(BD(rate=linear, step=7, since=3, total=9))\n");
    const GrowthCall& relaxed = *coatAt(program, 1).map->growth;
    EXPECT_DOUBLE_EQ(*relaxed.cellUm, 50.0);
    EXPECT_EQ(relaxed.arrival->text, "-");
    EXPECT_NEAR((*relaxed.from)[0], 0.6, 1e-15); // made a unit vector
    EXPECT_NEAR((*relaxed.from)[2], 0.8, 1e-15);
    EXPECT_DOUBLE_EQ(*relaxed.reachUm, 1000.0);
    const GrowthCall& patches = *coatAt(program, 2).map->growth;
    EXPECT_EQ(patches.blocked->text, "wetness");
    EXPECT_EQ(*patches.patchCells, 12);
    EXPECT_DOUBLE_EQ(*patches.seeding, 1e-4);
    EXPECT_EQ(*coatAt(program, 3).map->growth->points, 300);
    EXPECT_EQ(coatAt(program, 4).map->growth->since, 3);
    EXPECT_TRUE(coatAt(program, 4).map->growth->ofFull); // a difference needs one measure for both
}

TEST(Parser, bindsMultiplicationTighterThanAdditionAndCountsFromTheLeft) {
    const auto thickness = [](const std::string& expression) {
        return coatAt(readScript("new copper\ncoat soot " + expression), 1).thicknessUm;
    };
    EXPECT_DOUBLE_EQ(thickness("1 + 2 * 3"), 7.0);
    EXPECT_DOUBLE_EQ(thickness("(1 + 2) * 3"), 9.0);
    EXPECT_DOUBLE_EQ(thickness("8 - 4 - 2"), 2.0);
    EXPECT_DOUBLE_EQ(thickness("8 / 4 / 2"), 1.0);
    EXPECT_DOUBLE_EQ(thickness("- -3"), 3.0);
    EXPECT_DOUBLE_EQ(thickness("2 * -3 + 10"), 4.0);
    EXPECT_DOUBLE_EQ(thickness("max(1, 5, 3) + min(4, 2)"), 7.0);
    EXPECT_DOUBLE_EQ(thickness("clamp(9, 0, 2) + mix(1, 3, 0.25) + pow(2, 3)"), 11.5);
    EXPECT_DOUBLE_EQ(thickness("smoothstep(0um, 10mm, 5mm)"), 0.5);
}

TEST(Parser, tellsAThicknessFromTheMapBehindIt) {
    const Program program = readScript("new copper\n"
                                       "param t = 2\n"
                                       "coat soot t (1 - wetness)\n"
                                       "coat soot 3 * t noise (1mm)\n"
                                       "coat soot t wetness\n");
    EXPECT_DOUBLE_EQ(coatAt(program, 1).thicknessUm, 2.0);
    EXPECT_EQ(coatAt(program, 1).map->text, "-");
    EXPECT_DOUBLE_EQ(coatAt(program, 2).thicknessUm, 6.0);
    EXPECT_EQ(coatAt(program, 2).map->text, "noise");
    EXPECT_EQ(coatAt(program, 3).map->text, "wetness");
}

TEST(Parser, saysWhatItExpectedAndWhatItFound) {
    const auto first = [](const std::string& statement) {
        return briefly(findingsOf("new copper\n" + statement)).at(0);
    };
    EXPECT_EQ(first("coat 0.35"), "2:6: expected the name of a material, found '0.35'");
    EXPECT_EQ(first("coat soot"), "2:10: expected a thickness, found the end of the statement");
    EXPECT_EQ(first("coat soot 1 +"), "2:14: expected a number, a map or '(', found the end of the statement");
    EXPECT_EQ(first("coat soot 1 texture(BD.linear)"),
              "2:23: expected a growth pattern's short form, NAME.rate_step.total (such as BD.linear_1.20), found "
              "'.linear'");
    EXPECT_EQ(first("coat soot 1 noise(1mm 2)"), "2:23: expected ',' or ')', found '2'");
    EXPECT_EQ(first("coat soot 1 noise(1mm) coat dirt 2"),
              "2:24: expected the end of the statement (';' or a new line), found 'coat'");
    EXPECT_EQ(first("convert soot dirt 0.5"), "2:14: expected 'to', found 'dirt'");
    EXPECT_EQ(first("erode 2 by weight"), "2:12: expected 'hardness' behind 'by', found 'weight'");
    EXPECT_EQ(first("fill dirt 2 above 3"), "2:19: expected 'smooth(radius)' behind 'above', found '3'");
    EXPECT_EQ(first("curve c = 1"), "2:11: expected a point, (year, value), found '1'");
    EXPECT_EQ(first("open x.vdb"), "2:6: expected the name of a volume's file in quotes, found 'x.vdb'");
    EXPECT_EQ(first("let = 3"), "2:5: expected a name to declare, found '='");
    EXPECT_EQ(first("coat soot 3 $"), "2:13: expected the end of the statement (';' or a new line), found '$'");
    EXPECT_EQ(first("coat soot 3parsec"), "2:12: unknown unit 'parsec'");
    EXPECT_EQ(first("coat soot 1e999"), "2:11: the number is too large");
    EXPECT_EQ(first("cot soot 3"), "2:1: unknown statement 'cot'");
    EXPECT_EQ(first("= 3"), "2:1: expected a statement, found '='");
}

TEST(Parser, countsColumnsInCharactersNotBytes) {
    const std::vector<Diagnostic> findings = findingsOf("new copper\ncoat soot 2µm nope");
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].place.column, 15);
    EXPECT_EQ(findings[0].text(), "test.patina:2:15: error: unknown name 'nope'\n"
                                  "    coat soot 2µm nope\n"
                                  "                  ^");
}

TEST(Parser, namesThePlaceWhereSomethingOpenedThatIsNotClosed) {
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 noise(1mm;\ncoat dirt 2")),
                ElementsAre("2:18: '(' is not closed"));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 texture(\"a.png)\ncoat dirt 2")),
                ElementsAre("2:21: the quoted text is not closed"));
    EXPECT_THAT(briefly(findingsOf("new copper\nrepeat 2 {\ncoat dirt 2")), ElementsAre("2:10: '{' is not closed"));
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat dirt 2)")), ElementsAre("2:12: ')' closes no '('"));
    EXPECT_THAT(briefly(findingsOf("new copper\n}\n")), ElementsAre("2:1: '}' closes no '{'"));
    EXPECT_THAT(briefly(findingsOf("new copper\n{ coat dirt 2 }\n")), ElementsAre("2:1: a block stands alone"));
    EXPECT_THAT(briefly(findingsOf("new copper\nrepeat 2\ncoat dirt 2\n")), ElementsAre("2:1: 'repeat' needs a block"));
}

TEST(Parser, findsTheErrorsBehindAnOpenBracket) {
    // The line behind begins with a statement's word: no expression can, so the bracket was forgotten.
    EXPECT_THAT(briefly(findingsOf("new copper\ncoat soot 1 noise(1mm\ncoat dirt nope\ncoat nope 1\n")),
                ElementsAre("2:18: '(' is not closed", "3:11: unknown name 'nope'", "4:6: unknown material 'nope'"));
}

} // namespace
} // namespace patina
