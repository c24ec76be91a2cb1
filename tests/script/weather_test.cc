// What `weather` knows and writes: amounts by their published formulas, and scripts that go on from each other.

#include "script/weather_script.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include "script_context.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace patina {
namespace {

const std::filesystem::path dataFolder = std::filesystem::path(PATINA_SOURCE_DIR) / "data";

WeatherPlan plan(const std::string& environment, const std::string& metal = "copper") {
    return readWeatherPlan(dataFolder, environment, metal);
}

WeatherKinetics category(const std::string& name, double position = 0.5) {
    WeatherKinetics kinetics;
    kinetics.category = name;
    kinetics.position = position;
    return kinetics;
}

TEST(Weather, ThePapersRatesAreMeansOverTwentyYearsAndEndThere) {
    // Dorsey & Hanrahan 1996, §2.2: 1, 0.5 and 1 to 2 µm a year.
    EXPECT_NEAR(patinaThicknessUm(plan("marine"), {}, 20.0) / 20.0, 1.0, 1e-12);
    EXPECT_NEAR(patinaThicknessUm(plan("rural"), {}, 20.0) / 20.0, 0.5, 1e-12);
    EXPECT_NEAR(patinaThicknessUm(plan("urban"), {}, 20.0) / 20.0, 1.5, 1e-12);
    EXPECT_DOUBLE_EQ(patinaThicknessUm(plan("marine"), {}, 100.0), patinaThicknessUm(plan("marine"), {}, 20.0));
    EXPECT_GT(patinaThicknessUm(plan("marine"), {}, 1.0), 1.5); // fastest at first
}

TEST(Weather, CategoriesFollowISO9224) {
    const WeatherPlan copper = plan("marine");
    const double first = patinaThicknessUm(copper, category("C4"), 1.0);
    // The standard's own table of t^b (B1): 2 and 3 years.
    EXPECT_NEAR(patinaThicknessUm(copper, category("C4"), 2.0) / first, 1.588, 6e-4);
    EXPECT_NEAR(patinaThicknessUm(copper, category("C4"), 3.0) / first, 2.081, 6e-4);
    EXPECT_NEAR(patinaThicknessUm(copper, category("C4"), 20.0) / first, 7.375, 2e-3);
    // Least and most of the category: 1.3 and 2.8 µm of copper in the first year.
    const double mineral = copper.expansion * copper.retained;
    EXPECT_NEAR(patinaThicknessUm(copper, category("C4", 0.0), 1.0), 1.3 * mineral, 1e-12);
    EXPECT_NEAR(patinaThicknessUm(copper, category("C4", 1.0), 1.0), 2.8 * mineral, 1e-12);
    // Along the tangent after 20 years.
    const auto at = [&](double years) { return patinaThicknessUm(copper, category("C4"), years); };
    EXPECT_NEAR(at(40.0) - at(30.0), at(30.0) - at(20.0), 1e-9);
    EXPECT_NEAR((at(20.001) - at(20.0)) / 0.001, (at(20.0) - at(19.999)) / 0.001, 1e-3);
}

// The city's rate is a range: 1 to 2 µm.
TEST(Weather, ThePapersRangeHasALeastAndAMost) {
    EXPECT_TRUE(hasPaperRange(plan("urban")));
    EXPECT_FALSE(hasPaperRange(plan("marine")));
    WeatherKinetics kinetics;
    for (const double position : {0.0, 0.5, 1.0}) {
        kinetics.position = position;
        EXPECT_NEAR(patinaThicknessUm(plan("urban"), kinetics, 20.0) / 20.0, 1.0 + position, 1e-12);
    }
}

// Molar volume per atom of copper, over copper's own: from molar mass (g/mol), atoms of copper and density (g/cm³).
TEST(Weather, ExpansionsFollowFromMolarVolumes) {
    const double copper = 63.546 / 8.96;
    const auto ratio = [&](double mass, int atoms, double density) { return mass / density / atoms / copper; };
    const double cuprite = ratio(143.09, 2, 6.0), sulphide = ratio(159.15, 2, 5.65);
    const double posnjakite = ratio(470.30, 4, 3.335), brochantite = ratio(452.28, 4, 3.97);
    const double antlerite = ratio(354.72, 3, 3.9), atacamite = ratio(213.56, 2, 3.76);
    const WeatherPlan urban = plan("urban"), rural = plan("rural");
    EXPECT_NEAR(urban.oxides[0].expansion, 1.0 / (0.85 / cuprite + 0.15 / sulphide), 0.01);
    EXPECT_NEAR(rural.minerals[0].expansion, 1.0 / (0.668 / posnjakite + 0.129 / brochantite + 0.103 / atacamite), 0.02);
    EXPECT_NEAR(urban.minerals[1].expansion, 1.0 / (0.233 / antlerite + 0.667 / brochantite), 0.02);
    EXPECT_GT(rural.minerals[0].expansion, rural.minerals[1].expansion); // posnjakite is the bulkier
}

// What is not washed away of the metal lost is in the layers, each µm of them holding 1 / expansion of it.
TEST(Weather, TheMetalOfACategoryIsInTheLayers) {
    for (const std::string& name : weatherPlans(dataFolder)) {
        const std::size_t split = name.find('_');
        const WeatherPlan one = plan(name.substr(split + 1), name.substr(0, split));
        for (const double years : {25.0, 60.0}) {
            const auto layers = layerThicknessesUm(one, category("C4"), years);
            double metal = 0.0;
            for (std::size_t i = 0; i < layers.size(); ++i)
                metal += layers[i] / (i < one.oxides.size() ? one.oxides[i].expansion
                                                            : one.minerals[i - one.oxides.size()].expansion);
            EXPECT_NEAR(metal, patinaThicknessUm(one, category("C4"), years) / one.expansion, 2e-3 * metal) << name;
        }
    }
}

// Half of every µm in a half-life: a stock that was there from the start halves, and frames compose.
TEST(Weather, ConversionIsTheSameInOneFrameAndInMany) {
    const WeatherPlan rural = plan("rural");
    const WeatherConversion& turning = rural.conversions.at(0);
    const auto grown = [&](double year) { return layerThicknessesUm(rural, {}, year)[rural.oxides.size()]; };
    const auto leftAfter = [&](const std::vector<double>& years) {
        double left = 0.0, before = 0.0;
        for (const double year : years) {
            left = (left + grown(year) - grown(before)) * (1.0 - convertedFraction(rural, {}, turning, before, year));
            before = year;
        }
        return left;
    };
    std::vector<double> many;
    for (double year = 1.5; year <= 30.0; year += 1.5)
        many.push_back(year);
    EXPECT_NEAR(leftAfter({30.0}), leftAfter(many), 0.01 * leftAfter(many));
    EXPECT_LT(leftAfter({30.0}), grown(30.0));
    // Nothing grows after 20 years: by then only half of it is left after each half-life.
    EXPECT_NEAR(convertedFraction(rural, {}, turning, 40.0, 40.0 + turning.halfLifeYears), 0.5, 0.01);
    EXPECT_EQ(convertedFraction(rural, {}, turning, 0.0, turning.begins), 0.0);
}

// Figure 2: tarnish, cuprite, then the minerals of the third and fourth stage; and when the green comes, as published:
// 5 to 7 years by the sea, where it "reaches a dominant stage" in the country in 10 to 14 (Copper Development
// Association); in the city "much earlier", an almost continuous coating half way through thirty years (§5.1).
TEST(Weather, StagesComeInTheOrderAndAtTheTimesOfFigureTwo) {
    const auto layersAt = [](const WeatherPlan& one, double year) { return layerThicknessesUm(one, {}, year); };
    // Of the room that oxides leave, the part that minerals have taken.
    const auto greenAt = [&](const WeatherPlan& one, double year) {
        const auto layers = layersAt(one, year);
        double oxides = 0.0, minerals = 0.0;
        for (std::size_t i = 0; i < layers.size(); ++i)
            (i < one.oxides.size() ? oxides : minerals) += layers[i];
        return minerals / (patinaThicknessUm(one, {}, year) - oxides);
    };
    for (const char* environment : {"marine", "rural", "urban"}) {
        const WeatherPlan one = plan(environment);
        ASSERT_EQ(one.oxides.size() + one.minerals.size(), 4u);
        const auto last = layersAt(one, 30.0);
        double before = 0.0;
        for (std::size_t i = 0; i < last.size(); ++i) { // half of each is there
            double year = 0.0;
            while (layersAt(one, year)[i] < 0.5 * last[i])
                year += 0.1;
            EXPECT_GT(year, before) << environment << ", stage " << i + 1;
            before = year;
        }
        EXPECT_NE(one.oxides[0].material.find("tarnish"), std::string::npos);
        EXPECT_NE(one.oxides[1].material.find("cuprite"), std::string::npos);
        for (std::size_t i = 0; i < 2; ++i)
            EXPECT_NE(one.minerals[i].material.find(i == 0 ? "_3" : "_4"), std::string::npos);
    }
    EXPECT_LT(greenAt(plan("marine"), 5.0), 0.5);
    EXPECT_GT(greenAt(plan("marine"), 7.0), 0.5);
    EXPECT_LT(greenAt(plan("rural"), 7.0), 0.25);
    EXPECT_GT(greenAt(plan("rural"), 10.0), 0.5);
    EXPECT_GT(greenAt(plan("rural"), 14.0), 0.95);
    EXPECT_GT(greenAt(plan("urban"), 3.0), 0.95);
    for (const double year : {2.0, 4.0, 8.0})
        EXPECT_GT(greenAt(plan("urban"), year), greenAt(plan("rural"), year) + 0.2) << year;
    // Posnjakite is the first sulphate on land, and turns.
    for (const char* environment : {"rural", "urban"})
        EXPECT_EQ(plan(environment).conversions.at(0).from, plan(environment).minerals[0].material);
    EXPECT_LT(plan("urban").conversions[0].halfLifeYears, plan("rural").conversions[0].halfLifeYears);
    EXPECT_TRUE(plan("marine").conversions.empty());
}

// The steps of a pattern and its even part depend on the year alone: the last frame of many is that of two.
TEST(Weather, FramesDoNotChangeWhatIsThereInTheEnd) {
    const auto last = [](int frames) {
        std::vector<double> years;
        for (int i = 0; i < frames; ++i)
            years.push_back(30.0 * i / (frames - 1));
        std::map<std::string, std::pair<int, double>> out; // step and even µm by material
        for (const WeatherFrame& frame : weatherScripts(plan("marine"), {}, years, "marine")) {
            CheckContext context = testContext();
            context.checkFiles = false;
            for (const Statement& statement : readScript(frame.script, context).statements) {
                const auto* coat = std::get_if<Coat>(&statement.action);
                const auto* grow = std::get_if<Grow>(&statement.action);
                if (!coat && !grow)
                    continue;
                EXPECT_TRUE(coat || grow->everywhere);
                auto& [step, even] = out[coat ? coat->material : grow->material];
                const double um = coat ? coat->thicknessUm : grow->thicknessUm;
                const std::optional<Expression>& whole = coat ? coat->map : grow->map;
                const Expression* map = whole ? &*whole : nullptr;
                while (map && map->kind == Expression::Kind::binary)
                    map = &map->children[0];
                if (map && map->text == "mix" && map->children[2].kind == Expression::Kind::growth) {
                    even += map->children[0].number * um;
                    map = &map->children[2];
                }
                if (map && map->kind == Expression::Kind::growth)
                    step = map->growth->step;
                else
                    even += um;
            }
        }
        return out;
    };
    const auto two = last(2), many = last(13);
    ASSERT_EQ(two.size(), 4u);
    for (const auto& [material, end] : two) {
        EXPECT_EQ(many.at(material).first, end.first) << material;
        EXPECT_NEAR(many.at(material).second, end.second, 0.01 * end.second + 0.002) << material;
    }
}

TEST(Weather, LayersAddUpToThePatinaAndNeverShrink) {
    for (const std::string& name : weatherPlans(dataFolder)) {
        const std::size_t split = name.find('_');
        const std::string metal = name.substr(0, split);
        const WeatherPlan one = plan(name.substr(split + 1), metal);
        const WeatherKinetics kinetics = metal == "copper" ? WeatherKinetics{} : category("C3");
        std::vector<double> before;
        for (double year = 0.0; year <= 60.0; year += 1.5) {
            const auto layers = layerThicknessesUm(one, kinetics, year);
            for (std::size_t i = 0; i < before.size(); ++i)
                EXPECT_GE(layers[i], before[i] - 1e-9) << name << " layer " << i << " in year " << year;
            before = layers;
        }
        const double sum = std::accumulate(before.begin(), before.end(), 0.0);
        // The paper's growth ends after 20 years, the oxides' not quite.
        EXPECT_NEAR(sum, patinaThicknessUm(one, kinetics, 60.0), 2e-3 * sum) << name;
    }
}

TEST(Weather, FramesGoOnFromEachOther) {
    const auto frames = weatherScripts(plan("marine"), {}, {0.0, 10.0, 20.0, 30.0}, "marine");
    ASSERT_EQ(frames.size(), 4u);
    EXPECT_NE(frames[0].script.find("new copper;"), std::string::npos);
    EXPECT_EQ(frames[0].script.find("coat"), std::string::npos); // bare metal in year 0
    for (std::size_t i = 1; i < frames.size(); ++i)
        EXPECT_NE(frames[i].script.find("open \"../" + frames[i - 1].folder + "/marine.vdb\""), std::string::npos);
    EXPECT_TRUE(
        std::is_sorted(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.folder < b.folder; }));
}

TEST(Weather, EveryScriptPassesTheChecker) {
    CheckContext context = testContext();
    context.checkFiles = false;
    for (const char* name : {"zinc", "steel"})
        context.materials.push_back({name, true});
    for (const char* name : {"zinc_oxide", "zinc_carbonate", "magnetite", "lepidocrocite", "goethite"})
        context.materials.push_back({name, false});
    for (const std::string& name : weatherPlans(dataFolder)) {
        const std::size_t split = name.find('_');
        if (name.compare(0, 6, "copper") != 0 && name.find("marine") == std::string::npos)
            continue; // zinc and steel differ between environments by a number only
        for (const auto& frame : weatherScripts(plan(name.substr(split + 1), name.substr(0, split)), category("C5"),
                                                {0, 0.5, 3, 12, 40}, "x"))
            EXPECT_NO_THROW(readScript(frame.script, context)) << name << ", year " << frame.year << "\n"
                                                               << frame.script;
    }
}

// The mean thickness that the statements of a material ask for, where its map is 1.
TEST(Weather, MeanThicknessOfTheStatementsIsTheKinetics) {
    // Random deposition's mean is its age, and its top age + 3 sqrt(age): amounts can be summed by hand.
    test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "weather");
    writeTextFile(folder / "weather/kinetics.toml",
                  "[copper]\nexponent = 1.0\n[copper.first_year_um]\nC1 = [1.0, 1.0]\n");
    writeTextFile(folder / "weather/copper_lab.toml",
                  "title = \"Lab\"\nmetal = \"copper\"\nkinetics = \"copper\"\nexpansion = 1.0\n"
                  "retained = 1.0\n[[mineral]]\nmaterial = \"soot\"\nbegins = [0, 0]\n"
                  "pattern = \"RD\"\ntotal = 9\neven = 0.25\n");
    const WeatherPlan lab = readWeatherPlan(folder.path(), "lab", "copper");
    CheckContext context = testContext();
    context.checkFiles = false;
    const double top = 9.0 + 3.0 * 3.0;
    double sum = 0.0;
    int step = 0;
    for (const auto& frame : weatherScripts(lab, category("C1"), {7.0, 19.0, 30.0}, "lab")) {
        const Program program = readScript(frame.script, context);
        for (const Statement& statement : program.statements) {
            double um = 0.0;
            const Expression* map = nullptr;
            if (const auto* coat = std::get_if<Coat>(&statement.action))
                um = coat->thicknessUm, map = coat->map ? &*coat->map : nullptr;
            else if (const auto* grow = std::get_if<Grow>(&statement.action))
                um = grow->thicknessUm, map = grow->map ? &*grow->map : nullptr;
            else
                continue;
            double even = 1.0;
            const GrowthCall* growth = nullptr;
            if (map && map->kind == Expression::Kind::growth) {
                even = 0.0;
                growth = map->growth.get();
            } else if (map && map->text == "mix") {
                even = map->children[0].number;
                growth = map->children[2].growth.get();
            }
            double mean = even * um;
            if (growth) {
                EXPECT_EQ(growth->since, step);
                step = growth->step;
                mean += (1.0 - even) * um * (growth->step - growth->since) / top;
            }
            sum += mean;
        }
        EXPECT_NEAR(sum, frame.year, 0.002 * frame.year) << frame.script;
    }
    EXPECT_EQ(step, 9); // the whole pattern in the reference year
}

TEST(Weather, WhatIsNotThereIsSaid) {
    EXPECT_THROW(plan("lunar"), Error);
    EXPECT_THROW(patinaThicknessUm(plan("marine"), category("C9"), 1.0), Error);
    EXPECT_THROW(patinaThicknessUm(plan("marine", "zinc"), {}, 1.0), Error); // the paper speaks of copper
    EXPECT_THROW(weatherScripts(plan("marine"), {}, {5.0, 5.0}, "x"), Error);
    EXPECT_THROW(weatherScripts(plan("marine"), {}, {-1.0}, "x"), Error);
}

TEST(Weather, TheLatitudeIsOfBothSunAndRain) {
    WeatherPlan here = plan("urban");
    setLatitude(here, -33.5);
    bool sun = false, rain = false;
    for (const WeatherFrame& frame : weatherScripts(here, {}, {12.0, 30.0}, "urban")) {
        EXPECT_EQ(frame.script.find("exposure)"), std::string::npos) << frame.script;
        sun = sun || frame.script.find("exposure(latitude=-33.5)") != std::string::npos;
        rain = rain || frame.script.find("wetness(latitude=-33.5)") != std::string::npos;
    }
    EXPECT_TRUE(sun && rain);
    setLatitude(here, 10.0); // what has its arguments keeps them
    EXPECT_NE(here.wear[0].map.find("latitude=-33.5"), std::string::npos) << here.wear[0].map;
    EXPECT_THROW(setLatitude(here, 90.5), Error);
}

TEST(Weather, FaultsOfAPlanAreToldWithTheirPlaces) {
    test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "weather");
    writeTextFile(folder / "weather/kinetics.toml",
                  "[copper]\nexponent = 0.667\n[copper.first_year_um]\nC1 = [0.5, 0.1]\n");
    writeTextFile(folder / "weather/copper_lab.toml",
                  "title = \"Lab\"\nmetal = \"copper\"\nkinetics = \"copper\"\n"
                  "expansion = 4.0\nretained = 2.0\n[[mineral]]\nmaterial = \"soot\"\n"
                  "begins = [3]\npatern = \"RD\"\npattern = \"XY\"\ntotal = 9\neven = 0.2\n");
    try {
        readWeatherPlan(folder.path(), "lab", "copper");
        FAIL() << "the plan was read";
    } catch (const ScriptError& error) {
        std::vector<int> lines;
        for (const Diagnostic& one : error.diagnostics())
            lines.push_back(one.place.line);
        // Retained share, begins, the key, the model; the range of C1 in the other file.
        EXPECT_EQ(lines, (std::vector<int>{5, 9, 8, 10, 4}));
    }
}

} // namespace
} // namespace patina
