#include "script_context.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

namespace patina {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

/// "2:6: message (remedy)" of the first finding in a script that begins with `new copper` in line 1.
std::string firstError(const std::string& statements, const CheckContext& context = testContext()) {
    const std::vector<Diagnostic> findings = findingsOf("new copper\n" + statements, context);
    if (findings.empty())
        return {};
    const std::string remedy = findings[0].remedy.empty() ? "" : " (" + findings[0].remedy + ")";
    return briefly(findings)[0] + remedy;
}

std::vector<std::string> warningsOf(const std::string& statements) {
    return briefly(readScript("new copper\n" + statements).warnings);
}

TEST(Checker, readsAnErrorAsTheInterfaceShowsIt) {
    const std::vector<Diagnostic> findings = findingsOf("new copper;\n\ncoat         cuprit 1.2 noise(1mm);\n");
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].text(), "test.patina:3:14: error: unknown material 'cuprit'\n"
                                  "    coat         cuprit 1.2 noise(1mm);\n"
                                  "                 ^\n"
                                  "    did you mean 'cuprite_2'?");
}

TEST(Checker, tellsAllErrorsOfAScriptInOneGoInTheOrderOfTheText) {
    EXPECT_THAT(briefly(findingsOf("new cooper\n"
                                   "coat cuprit 1.2 texture(BD.liner_30.20)\n"
                                   "coat soot -1 noise(nope) as a as b\n"
                                   "wash soot\n"
                                   "erode 1 0.5 by\n"
                                   "fill copper 2\n")),
                ElementsAre("1:5: unknown metal 'cooper'", "2:6: unknown material 'cuprit'",
                            "2:28: unknown growth rate 'liner'", "2:34: step 30 is beyond the total of 20",
                            "3:11: the thickness is negative: -1 µm", "3:20: unknown name 'nope'",
                            "3:31: 'as' stands here twice", "4:1: unknown statement 'wash'",
                            "5:15: expected 'hardness' behind 'by', found the end of the statement",
                            "6:6: 'copper' is a metal, a layer's material is needed here"));
}

TEST(Checker, tellsMetalsFromLayers) {
    EXPECT_THAT(briefly(findingsOf("new soot")),
                ElementsAre("1:5: 'soot' is a layer's material, a metal is needed here"));
    EXPECT_EQ(firstError("coat bronze 1"),
              "2:6: 'bronze' is a metal, a layer's material is needed here (a metal begins "
              "the script: new bronze)");
    EXPECT_EQ(firstError("convert copper to soot 1"), "2:9: 'copper' is a metal, a layer's material is needed here (a "
                                                      "metal begins the script: new copper)");
    EXPECT_NO_THROW(readScript("new bronze\ncoat soot 1\npolish area 0.1 of bronze"));
}

TEST(Checker, wantsABeginningAndOnlyOne) {
    EXPECT_THAT(briefly(findingsOf("")), ElementsAre("0:0: the script begins nothing"));
    EXPECT_THAT(briefly(findingsOf("# only a comment\n")), ElementsAre("0:0: the script begins nothing"));
    EXPECT_THAT(briefly(findingsOf("coat soot 1\nerode 2\n")),
                ElementsAre("1:1: 'coat' comes before the object has begun"));
    EXPECT_EQ(firstError("coat soot 1\nnew bronze"), "3:1: 'new' begins the object a second time (it began in line 1)");
    EXPECT_THAT(briefly(findingsOf("repeat 2 { new copper }")), testing::Contains("1:12: 'new' cannot be repeated"));
    // Declarations may stand before it.
    EXPECT_NO_THROW(readScript("param t = 1; let n = noise(1mm); curve c = (0, 0) (1, 1); seed 3; new copper\n"
                               "coat soot t * c(1) n"));
}

TEST(Checker, knowsTheWordsOfGrowth) {
    EXPECT_EQ(firstError("coat soot 1 texture(BE.linear_1.20)"),
              "2:21: unknown growth model 'BE' (did you mean 'BD'?)");
    EXPECT_EQ(firstError("coat soot 1 texture(percolation(rate=linear, step=1, total=2))"),
              "2:21: unknown growth model 'percolation' (the models are ST, RD, RDR, BD, DPD and DPD_BS)");
    EXPECT_EQ(firstError("coat soot 1 texture(BD.quadratic_1.20)"),
              "2:24: unknown growth rate 'quadratic' (the rates are linear, parabolic, cubic and logarithmic)");
    EXPECT_EQ(firstError("coat soot 1 texture(BD(rate=cubik, step=1, total=20))"),
              "2:29: unknown growth rate 'cubik' (did you mean 'cubic'?)");
    EXPECT_THAT(firstError("coat soot 1 texture(BD.linear_21.20)"),
                HasSubstr("2:31: step 21 is beyond the total of 20"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD(rate=linear, total=20, step=21))"),
                HasSubstr("2:52: step 21 is beyond the total of 20"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD.linear_0.20)"), HasSubstr("2:31: the step must be at least 1"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD.linear_0.0)"), HasSubstr("2:33: the total must be 1 to 1000000"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD(rate=linear, step=0, total=20))"),
                HasSubstr("2:42: the step must be 1 to 1000000, this is 0"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD(rate=linear, step=1.5, total=20))"),
                HasSubstr("2:42: the step must be a whole number, this is 1.5"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD.linear_1.9999999999)"), HasSubstr("the number is too large"));
    EXPECT_EQ(firstError("coat soot 1 BD.linear_1.20"),
              "2:13: a growth pattern stands inside texture( ) (texture(BD.linear_1.20))");
    EXPECT_EQ(firstError("coat soot 1 texture(BD)"),
              "2:21: the growth model 'BD' needs a rate, a step and a total (texture(BD.linear_1.20))");
}

TEST(Checker, leavesNoArgumentOfGrowthUnread) {
    const auto growth = [](const std::string& more) {
        return firstError("coat soot 1 texture(RD(rate=linear, step=1, total=2, " + more + "))");
    };
    EXPECT_EQ(growth("sell=1"), "2:54: unknown argument 'sell' (did you mean 'cell'?)");
    EXPECT_EQ(growth("step=2"), "2:54: the argument 'step' is given twice");
    EXPECT_EQ(growth("reach=2"),
              "2:54: the growth model 'RD' does not use the argument 'reach' (it uses rate, step, total, since, cell, "
              "arrival and from)");
    EXPECT_EQ(firstError("coat soot 1 texture(RD(rate=linear, step=2, total=4, since=2))"),
              "2:60: step 2 does not come after step 2 (since=N is an earlier step of the same history)");
    EXPECT_THAT(growth("3"), HasSubstr("2:54: the arguments of a growth model are named"));
    EXPECT_THAT(growth("cell=0"), HasSubstr("2:59: the size of a cell must be larger than 0"));
    EXPECT_THAT(growth("arrival=2"), HasSubstr("2:62: 'arrival' must be between 0 and 1, this is 2"));
    EXPECT_THAT(growth("arrival=2mm"), HasSubstr("2:62: 'arrival' is a number or a map without a unit"));
    EXPECT_THAT(growth("from=(0, 0)"), HasSubstr("2:59: a direction has three numbers"));
    EXPECT_THAT(growth("from=(0, 0, 0)"), HasSubstr("2:59: the direction (0, 0, 0) comes from nowhere"));
    EXPECT_THAT(firstError("coat soot 1 texture(RD(step=1, total=2))"),
                HasSubstr("2:21: the growth model 'RD' needs the argument 'rate'"));
}

TEST(Checker, knowsKindsOfQuantity) {
    EXPECT_THAT(firstError("coat soot 2mm + 3"), HasSubstr("2:15: a length and a plain number cannot be added"));
    EXPECT_THAT(firstError("coat soot 2mm * 3mm"), HasSubstr("2:15: two lengths are multiplied"));
    EXPECT_THAT(firstError("coat soot 2 / 3mm"), HasSubstr("2:13: a plain number is divided by a length"));
    EXPECT_THAT(firstError("coat soot 2 / (1 - 1)"), HasSubstr("2:13: division by zero"));
    EXPECT_THAT(firstError("coat soot 1e300 * 1e300"), HasSubstr("2:17: the number is too large"));
    EXPECT_THAT(firstError("coat soot pow(-1, 0.5)"), HasSubstr("2:11: 'pow' has no value here"));
    EXPECT_THAT(firstError("coat soot 1 2mm"), HasSubstr("2:13: a map is a factor without a unit, this is a length"));
    EXPECT_THAT(firstError("coat soot 1 noise(1mm) * 2mm"), HasSubstr("2:24: a map is a factor without a unit"));
    EXPECT_THAT(firstError("coat soot noise(1mm)"), HasSubstr("2:11: the thickness must be a number, this varies"));
    EXPECT_THAT(firstError("coat soot 1 * noise(1mm)"),
                HasSubstr("(a map stands behind the number, without an operator between them)"));
    EXPECT_THAT(firstError("polish area 2mm"), HasSubstr("2:13: the fraction of plateau is a number without a unit"));
    EXPECT_THAT(firstError("polish area 1.5"), HasSubstr("2:13: the fraction of plateau must be between 0 and 1"));
    EXPECT_THAT(firstError("coat soot 1\nconvert soot to dirt -0.1"),
                HasSubstr("the fraction must be between 0 and 1, this is -0.1"));
    EXPECT_THAT(firstError("coat soot 1 smoothstep(1, 2mm, noise(1))"),
                HasSubstr("2:27: the arguments of 'smoothstep' must be all lengths or all plain numbers"));
    EXPECT_THAT(firstError("coat soot 1 accessibility(0)"), HasSubstr("2:27: the radius must be larger than 0"));
    EXPECT_THAT(firstError("coat soot 1 turbulence(1mm, 2.5)"),
                HasSubstr("2:29: the number of octaves must be a whole"));
    EXPECT_THAT(firstError("coat soot 1 facing(0, 0, 0)"), HasSubstr("2:13: the direction (0, 0, 0) faces nowhere"));
    EXPECT_THAT(firstError("offset wax 0"), HasSubstr("2:12: the radius must be larger than 0"));
    EXPECT_THAT(firstError("seed -1"), HasSubstr("2:6: the seed must be 0 to"));
    // Lengths divided by lengths are factors.
    EXPECT_DOUBLE_EQ(coatAt(readScript("new copper\ncoat soot 3 * (1mm / 2mm)"), 1).thicknessUm, 1.5);
}

TEST(Checker, refusesNegativeThicknessAlsoWhereItIsComputed) {
    EXPECT_EQ(firstError("param t = 1\nerode 2 - 3 * t"), "3:9: the thickness is negative: -1 µm");
    EXPECT_EQ(firstError("fill dirt -2"), "2:11: the height is negative: -2 µm");
    EXPECT_EQ(firstError("polish -2"), "2:8: the height is negative: -2 µm");
    EXPECT_EQ(firstError("offset wax -1mm"), "2:12: the radius is negative: -1 mm");
    EXPECT_EQ(firstError("grow soot -1"), // behind the warning that there is no soot
              "2:6: there is no layer of 'soot' yet: nothing happens");
}

TEST(Checker, knowsFunctionsFieldsAndTheirArguments) {
    EXPECT_EQ(firstError("coat soot 1 nois(1mm)"), "2:13: unknown function 'nois' (did you mean 'noise'?)");
    EXPECT_EQ(firstError("coat soot 1 wetnes"), "2:13: unknown name 'wetnes' (did you mean 'wetness'?)");
    EXPECT_EQ(firstError("coat soot 1 noise"), "2:13: 'noise' needs arguments (it is written noise(size))");
    EXPECT_EQ(firstError("coat soot 1 noise()"),
              "2:13: 'noise' has 0 arguments, which is too few (it is written noise(size))");
    EXPECT_EQ(firstError("coat soot 1 noise(1, 2)"),
              "2:13: 'noise' has 2 arguments, which is too many (it is written noise(size))");
    EXPECT_EQ(firstError("coat soot 1 min(1)"),
              "2:13: 'min' has 1 argument, which is too few (it is written min(a, b))");
    EXPECT_EQ(firstError("coat soot 1 noise(size=1mm)"), "2:19: 'noise' takes no named arguments");
    EXPECT_EQ(firstError("coat soot 1 accessibility(2mm, soft=3mm)"),
              "2:37: a hand is no softer than it is wide (give `soft` a length up to that of the radius)");
    EXPECT_THAT(firstError("coat soot 1 accessibility(2mm, soft=0)"), HasSubstr("2:37: how soft it is must be"));
    EXPECT_THAT(firstError("coat soot 1 accessibility(2mm, hard=1mm)"),
                HasSubstr("2:32: 'accessibility' has no argument 'hard'"));
    EXPECT_THAT(firstError("coat soot 1 slope(2)"), HasSubstr("2:13: 'slope' has no arguments"));
    EXPECT_THAT(firstError("coat soot 1 \"a.png\""), HasSubstr("2:13: a quoted text can only be a texture's file"));
    EXPECT_THAT(firstError("coat soot 1 (1, 2)"), HasSubstr("2:13: a list has no place here"));
    EXPECT_THAT(firstError("coat soot 1 texture(noise(1mm))"),
                HasSubstr("2:21: texture needs an image file in quotes"));
    EXPECT_THAT(firstError("coat soot 1 texture(BD.linear_1.20, R)"),
                HasSubstr("2:37: texture of a growth pattern has one argument"));
    EXPECT_THAT(firstError("coat soot 1 noise(1mm) of full"),
                HasSubstr("2:24: 'of full' belongs behind a growth pattern"));
    EXPECT_THAT(firstError("render pictures"),
                HasSubstr("2:8: unknown result 'pictures' (what can be rendered: maps)"));
}

TEST(Checker, knowsWhichClausesBelongTogether) {
    EXPECT_EQ(firstError("coat soot 1 by hardness"), "2:13: 'by' does not belong to 'coat' (it takes 'as')");
    EXPECT_EQ(firstError("erode 1 global"), "2:9: 'global' does not belong to 'erode' (it takes 'as', 'by' and 'and')");
    EXPECT_EQ(firstError("polish 2 window 1mm"), "2:10: 'window' belongs to 'polish area' (polish area 0.3 …)");
}

TEST(Checker, findsTexturesNextToTheScriptAndMissesThoseThatAreNotThere) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "patina_script_textures";
    std::filesystem::create_directories(folder / "maps");
    std::ofstream(folder / "maps" / "a.ppm") << "P3 2 1 255 0 10 20 30 40 50";
    std::ofstream(folder / "maps" / "text.png") << "no image";
    const std::string script = (folder / "test.patina").string();
    const std::string text = "new copper\ncoat soot 1 texture(\"maps/a.ppm\", G)";
    const Program program = readProgram(text, script, testContext());
    const Expression& map = *coatAt(program, 1).map;
    EXPECT_EQ(map.children.at(0).text, (folder / "maps/a.ppm").string());
    EXPECT_EQ(map.children.at(1).text, "G");

    const Program numbered = readProgram("new copper\ncoat soot 1 texture(\"maps/a.ppm\", 2)", script, testContext());
    EXPECT_DOUBLE_EQ(coatAt(numbered, 1).map->children.at(1).number, 2.0);

    CheckContext elsewhere = testContext();
    elsewhere.baseFolder = folder / "maps";
    EXPECT_NO_THROW(readScript("new copper\ncoat soot 1 texture(\"a.ppm\")", elsewhere));
    EXPECT_THAT(firstError("coat soot 1 texture(\"maps/a.ppm\")", elsewhere),
                HasSubstr("2:21: the texture 'maps/a.ppm' does not exist"));
    EXPECT_THAT(firstError("coat soot 1 texture(\"\")"), HasSubstr("2:21: the name of the texture is empty"));
    // A folder is no texture.
    elsewhere.baseFolder = folder;
    EXPECT_THAT(firstError("coat soot 1 texture(\"maps\")", elsewhere), HasSubstr("does not exist"));
    EXPECT_THAT(briefly(findingsOf("open \"nothing.vdb\"\ncoat soot 1")),
                ElementsAre("1:6: the volume 'nothing.vdb' does not exist"));

    // An image that is none, and channels that it has not.
    elsewhere.baseFolder = folder / "maps";
    EXPECT_THAT(firstError("coat soot 1 texture(\"text.png\")", elsewhere),
                HasSubstr("2:21: the texture 'text.png' cannot be read as an image"));
    EXPECT_EQ(firstError("coat soot 1 texture(\"a.ppm\", height)", elsewhere),
              "2:30: the texture 'a.ppm' has no channel 'height' (it has R, G and B)");
    EXPECT_EQ(firstError("coat soot 1 texture(\"a.ppm\", 3)", elsewhere),
              "2:30: the texture 'a.ppm' has no channel '3' (it has R, G and B)");
    EXPECT_THAT(briefly(findingsOf("new copper\nrepeat 3 { coat soot 1 texture(\"a.ppm\", A) }", elsewhere)),
                ElementsAre("2:41: the texture 'a.ppm' has no channel 'A'"));

    elsewhere.checkFiles = false;
    EXPECT_NO_THROW(readScript("open \"nothing.vdb\"\ngrow soot 1 texture(\"b.png\", height)", elsewhere));
    std::filesystem::remove_all(folder);
}

TEST(Checker, knowsTheModelsVertexAttributesWhereThereIsAModel) {
    EXPECT_NO_THROW(readScript("new copper\ncoat soot 1 vertices(anything)"));
    CheckContext context = testContext();
    context.vertexAttributes = {"dirtiness", "age"};
    EXPECT_NO_THROW(readScript("new copper\ncoat soot 1 vertices(age) * vertices(\"dirtiness\")", context));
    EXPECT_EQ(firstError("coat soot 1 vertices(dirtines)", context),
              "2:22: the model has no vertex attribute 'dirtines' (did you mean 'dirtiness'?)");
    EXPECT_EQ(firstError("coat soot 1 vertices(colour)", context),
              "2:22: the model has no vertex attribute 'colour' (the model has dirtiness and age)");
    context.vertexAttributes->clear();
    EXPECT_THAT(firstError("coat soot 1 vertices(colour)", context),
                HasSubstr("(the model has no per-vertex attributes)"));
}

TEST(Checker, saysBeforeAnythingRunsWhatThisBuildCannotDo) {
    CheckContext context = testContext();
    context.operators.erase("fill");
    context.functions.erase("wetness");
    context.functions.erase("accessibility");
    context.models.erase("DPD_BS");
    context.growthArguments.erase("from");
    context.clauses.erase("by");
    EXPECT_THAT(briefly(findingsOf("new copper\n"
                                   "fill dirt 2\n"
                                   "coat soot 1 wetness\n"
                                   "coat soot 1 1 - accessibility(2mm)\n"
                                   "coat soot 1 texture(DPD_BS.linear_1.2)\n"
                                   "coat soot 1 texture(RD(rate=linear, step=1, total=2, from=(0, 0, 1)))\n"
                                   "erode 1 by hardness\n",
                                   context)),
                ElementsAre("2:1: 'fill' is not there yet in this version",
                            "3:13: 'wetness' is not there yet in this version",
                            "4:17: 'accessibility' is not there yet in this version",
                            "5:21: the growth model 'DPD_BS' is not there yet in this version",
                            "6:54: the argument 'from' is not there yet in this version",
                            "7:9: 'erode … by' is not there yet in this version"));
}

TEST(Checker, givesEveryStatementItsLabel) {
    const auto labels = [](const std::string& text) {
        std::vector<std::string> out;
        for (const Statement& statement : readScript(text).statements)
            out.push_back(statement.label);
        return out;
    };
    EXPECT_THAT(
        labels("new copper\ncoat soot 1\ncoat dirt 1\ncoat soot 1\ncoat soot 1 as late\ncoat soot 1\nerode 1\nerode 1"),
        ElementsAre("new", "soot", "dirt", "soot#2", "late", "soot#4", "erode", "erode#2"));
    // A line in between changes nothing for the others.
    EXPECT_THAT(labels("new copper\ncoat soot 1\ncoat wax 1\ncoat soot 1"),
                ElementsAre("new", "soot", "wax", "soot#2"));
}

TEST(Checker, givesTwoPatternsOfOneStatementTwoKeys) {
    const Program program = readScript("new copper\n"
                                       "let spots = texture(BD.linear_1.20)\n"
                                       "coat soot 1 max(spots, spots)\n"
                                       "coat dirt 1 texture(RD(rate=linear, step=1, total=2, arrival=spots))\n");
    const Expression& both = *coatAt(program, 1).map;
    EXPECT_EQ(both.children.at(0).growth->label, "soot");
    EXPECT_EQ(both.children.at(1).growth->label, "soot/2");
    EXPECT_EQ(coatAt(program, 2).map->growth->label, "dirt");
    EXPECT_EQ(coatAt(program, 2).map->growth->arrival->growth->label, "dirt/2");
}

TEST(Checker, putsParametersAndLetsIn) {
    CheckContext context = testContext();
    const std::string text = "param depth = 2\n"
                             "param size = 3mm\n"
                             "let cloud = noise(size) * 0.5\n"
                             "new copper\n"
                             "coat soot depth * 2 cloud + 0.1\n";
    Program program = readScript(text, context);
    EXPECT_DOUBLE_EQ(coatAt(program, 1).thicknessUm, 4.0);
    const Expression& map = *coatAt(program, 1).map;
    EXPECT_DOUBLE_EQ(map.children.at(0).children.at(0).children.at(0).number, 3000.0);
    EXPECT_THAT(program.parameters,
                ElementsAre(AllOf(Field(&Parameter::name, "depth"), Field(&Parameter::value, 2.0),
                                  Field(&Parameter::wasSet, false)),
                            AllOf(Field(&Parameter::name, "size"), Field(&Parameter::isLength, true))));

    context.settings = {{"depth", "3um"}, {"size", " 1 cm "}};
    program = readScript(text, context);
    EXPECT_DOUBLE_EQ(coatAt(program, 1).thicknessUm, 6.0);
    EXPECT_DOUBLE_EQ(program.parameters.at(1).value, 1e4);
    EXPECT_TRUE(program.parameters.at(1).wasSet);

    context.settings = {{"depth", "-3"}};
    EXPECT_THAT(briefly(findingsOf(text, context)), ElementsAre("5:17: the thickness is negative: -6 µm"));
}

TEST(Checker, refusesASettingThatNoParameterHas) {
    CheckContext context = testContext();
    context.settings = {{"dept", "3"}};
    std::vector<Diagnostic> findings = findingsOf("new copper\nparam depth = 2\ncoat soot depth", context);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].text(), "--set dept=3: error: the script has no parameter 'dept'\n    did you mean 'depth'?");
    context.settings = {{"depth", "much"}};
    findings = findingsOf("new copper\nparam depth = 2\ncoat soot depth", context);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].text(), "--set depth=much: error: expected a number, found 'much'\n"
                                  "    a number with or without a unit, such as 0.3 or 2mm");
}

TEST(Checker, declaresANameOnceAndBeforeItsUse) {
    EXPECT_EQ(firstError("let a = 1\nparam a = 2\ncoat soot a"),
              "3:7: the name 'a' is taken (it was declared in line 2)");
    EXPECT_THAT(firstError("coat soot a\nlet a = 1"), HasSubstr("2:11: unknown name 'a'"));
    EXPECT_EQ(firstError("let noise = 1"), "2:5: 'noise' is a word of the language (choose another name)");
    EXPECT_EQ(firstError("let mm = 1"), "2:5: 'mm' is a word of the language (choose another name)");
    EXPECT_EQ(firstError("let coat = 1"), "2:5: 'coat' is a word of the language (choose another name)");
    EXPECT_THAT(firstError("param p = noise(1mm)"), HasSubstr("2:11: a parameter is a number, this varies"));
    EXPECT_THAT(firstError("param t = 1\ncoat soot t(2)"), HasSubstr("3:11: 't' is not a function"));
}

TEST(Checker, reportsABrokenDeclarationOnceAndNotAtItsUses) {
    EXPECT_THAT(briefly(findingsOf("new copper\nlet a = nois(1mm)\ncoat soot 1 a\ncoat dirt 1 a * a\n")),
                ElementsAre("2:9: unknown function 'nois'"));
    EXPECT_THAT(briefly(findingsOf("new copper\nlet a = noise(1mm\ncoat soot 1 a\n")),
                ElementsAre("2:14: '(' is not closed"));
    EXPECT_THAT(briefly(findingsOf("new copper\nparam p = 3zm\ncoat soot p a(2)\ncurve a = 3\n")),
                ElementsAre("2:12: unknown unit 'zm'", "4:11: expected a point, (year, value), found '3'"));
    EXPECT_THAT(briefly(findingsOf("new\ncoat soot 1\n")),
                ElementsAre("1:4: expected the name of a metal, found the end of the statement"));
}

TEST(Checker, drawsCurvesWithStraightLines) {
    const Program program = readScript("new copper\n"
                                       "curve share = (0, 0), (1, 0.5)\n"
                                       "curve thick = (0, 0um) (10, 5um) (20, 6um)\n"
                                       "coat soot 1 share(noise(1mm))\n"
                                       "coat soot thick(4)\n"
                                       "coat soot thick(15)\n"
                                       "coat soot thick(-1)\n"
                                       "coat soot thick(99)\n");
    const Expression& map = *coatAt(program, 1).map;
    ASSERT_EQ(map.kind, Expression::Kind::curve);
    EXPECT_EQ(map.children.at(0).text, "noise");
    EXPECT_DOUBLE_EQ(map.curve->value(0.5), 0.25);
    EXPECT_DOUBLE_EQ(coatAt(program, 2).thicknessUm, 2.0);
    EXPECT_DOUBLE_EQ(coatAt(program, 3).thicknessUm, 5.5);
    EXPECT_DOUBLE_EQ(coatAt(program, 4).thicknessUm, 0.0);
    EXPECT_DOUBLE_EQ(coatAt(program, 5).thicknessUm, 6.0);
    // The interface's own line.
    EXPECT_NO_THROW(readScript("new copper\ncurve c = (0, 0) (5, 1.2) (30, 2);\ncoat soot c(30)"));

    EXPECT_THAT(firstError("curve c = (0, 0) (5, 1) (3, 2)"),
                HasSubstr("2:25: the curve 'c' is not sorted: year 3 stands behind year 5"));
    EXPECT_THAT(firstError("curve c = (0, 0) (0, 1)"), HasSubstr("2:18: the curve 'c' has two points at year 0"));
    EXPECT_THAT(firstError("curve c = (0, 0, 1)"), HasSubstr("2:11: a point of a curve has two numbers"));
    EXPECT_THAT(firstError("curve c = (0)"), HasSubstr("2:11: a point of a curve has two numbers"));
    EXPECT_THAT(firstError("curve c = (0, 0) (1, 1mm)"), HasSubstr("2:22: the values of a curve must be all lengths"));
    EXPECT_THAT(firstError("curve c = (0, 0) (1, noise(1))"), HasSubstr("2:22: a curve's value is a number"));
    EXPECT_EQ(firstError("curve c = (0, 0) (1, 1)\ncoat soot c"), "3:11: the curve 'c' needs a year (c(30))");
    EXPECT_THAT(firstError("curve c = (0, 0) (1, 1)\ncoat soot c(1, 2)"),
                HasSubstr("3:11: the curve 'c' has one argument"));
}

TEST(Checker, smoothCurvesPassTheirPointsAndNeverOvershoot) {
    const Program program =
        readScript("new copper\ncurve c = (0, 0) (5, 1) (6, 4) (20, 4) (30, 5) smooth\ncoat soot c(5)");
    ASSERT_EQ(program.curves.size(), 1u);
    const Curve& curve = program.curves.front();
    for (const auto& [year, value] : curve.points)
        EXPECT_NEAR(curve.value(year), value, 1e-12) << year;
    double last = curve.value(-1.0), lastSlope = 0.0;
    const double step = 0.01;
    for (double year = -1.0; year < 31.0; year += step) {
        const double here = curve.value(year + step), slope = (here - last) / step;
        EXPECT_GE(here, last - 1e-12) << year;
        EXPECT_NEAR(slope, lastSlope, 0.25) << year; // a kink would be 2.8, the steepest piece bends by 17
        last = here;
        lastSlope = slope;
    }
    EXPECT_DOUBLE_EQ(curve.value(12.0), 4.0);
    EXPECT_NE(curve.value(2.0), 0.4);
}

TEST(Checker, unrollsRepeatWithItsStep) {
    const Program program = readScript("new copper\n"
                                       "repeat 3 {\n"
                                       "    let part = step / 3\n"
                                       "    coat soot 0.1 * step texture(BD(rate=linear, step=step, total=3)) * part\n"
                                       "    repeat 2 { erode step }\n"
                                       "}\n"
                                       "coat dirt 1\n");
    ASSERT_EQ(program.statements.size(), 1u + 3u * 3u + 1u);
    EXPECT_DOUBLE_EQ(coatAt(program, 7).thicknessUm, 0.1 * 3);
    EXPECT_EQ(coatAt(program, 4).map->children.at(0).growth->step, 2);
    EXPECT_DOUBLE_EQ(coatAt(program, 4).map->children.at(1).number, 2.0 / 3.0);
    EXPECT_EQ(program.statements[4].label, "soot#2");
    EXPECT_EQ(program.statements[4].repeatStep, 2);
    EXPECT_DOUBLE_EQ(std::get<Erode>(program.statements[6].action).thicknessUm, 2.0);
    EXPECT_EQ(program.statements[10].repeatStep, 0);

    EXPECT_THAT(firstError("repeat 0 { erode 1 }"), HasSubstr("2:8: the number of repetitions must be 1 to 100000"));
    EXPECT_THAT(firstError("repeat 2.5 { erode 1 }"),
                HasSubstr("2:8: the number of repetitions must be a whole number"));
    EXPECT_THAT(firstError("erode step"), HasSubstr("2:7: 'step' has a meaning inside 'repeat' only"));
    EXPECT_THAT(firstError("repeat 2 { param a = 1 }"), HasSubstr("2:12: 'param' cannot be repeated"));
    // An error inside is told once, not at every step.
    EXPECT_EQ(findingsOf("new copper\nrepeat 50 { coat soot -step }").size(), 1u);
}

TEST(Checker, warnsOfWhatIsProbablyNotMeant) {
    EXPECT_THAT(warningsOf("let a = noise(1mm)\ncoat soot 1"), ElementsAre("2:5: 'a' is never used"));
    EXPECT_THAT(warningsOf("param p = 1\ncurve c = (0, 0) (1, 1)"),
                ElementsAre("2:7: 'p' is never used", "3:7: 'c' is never used"));
    EXPECT_THAT(warningsOf("coat soot 1 1.5"),
                ElementsAre("2:13: the factor 1.5 is beyond 0 to 1 and will be clamped"));
    EXPECT_THAT(warningsOf("coat soot 1 0.3 - 0.5"),
                ElementsAre("2:17: the factor -0.2 is beyond 0 to 1 and will be clamped"));
    EXPECT_THAT(warningsOf("grow soot 1"), ElementsAre("2:6: there is no layer of 'soot' yet: nothing happens"));
    EXPECT_THAT(warningsOf("coat soot 1\ngrow soot 1\nconvert soot to dirt 0.5\ngrow dirt 1"), IsEmpty());
}

TEST(Checker, keepsTheSeed) {
    EXPECT_EQ(readScript("seed 42\nnew copper").seed, std::uint64_t{42});
    EXPECT_FALSE(readScript("new copper").seed.has_value());
    EXPECT_THAT(firstError("seed 1\nseed 2"), HasSubstr("3:1: the seed is given twice (it was given in line 2)"));
}

TEST(Checker, hasTheExitCodeOfAScriptError) {
    try {
        readScript("new gold");
        FAIL();
    } catch (const ScriptError& error) {
        EXPECT_EQ(error.code(), ExitCode::script);
        EXPECT_THAT(error.what(), HasSubstr("test.patina:1:5: error: unknown metal 'gold'"));
    }
    EXPECT_THROW(readProgramFile("/nowhere/at/all.patina", testContext()), RunError);
}

TEST(Checker, namesTheProgramAfterItsFile) {
    EXPECT_EQ(readProgram("new copper", "some/folder/by_the_sea.patina", testContext()).name, "by_the_sea");
}

} // namespace
} // namespace patina
