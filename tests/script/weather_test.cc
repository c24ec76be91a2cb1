// What `weather` knows and writes: amounts by their published formulas, and scripts that go on from each other.

#include "script/weather_script.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include "script_context.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <cmath>
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
