// The colours that real copper goes through.
#include "optics_test_support.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;
using test::shippedMaterials;

V3d bodyLab(const std::vector<const Material*>& materials, const std::vector<float>& thicknessUm) {
    return labFromXyz(xyzFromReflectance(StackOptics(materials).bodyReflectance(thicknessUm.data())));
}

Appearance look(const std::vector<std::string>& names, const std::vector<float>& thicknessUm) {
    std::vector<const Material*> materials;
    for (const std::string& name : names) {
        materials.push_back(&shippedMaterials().at(name));
    }
    Appearance appearance;
    StackOptics(materials).evaluate(thicknessUm.data(), appearance);
    return appearance;
}

TEST(PatinaColours, bareCopperIsItsNAndK) {
    EXPECT_LE(deltaE2000(test::labOf(test::total(look({"copper"}, {}))), {86.06, 11.85, 13.06}), 1.0);
}

// Kubelka–Munk alone, without the interface with the air, as the table was made.
TEST(PatinaColours, cupriteFilmsGoOrangeChestnutDarkBrown) {
    const struct {
        float thicknessUm;
        V3d lab;
    } films[] = {{0.05f, {61.5, 22.1, 68.8}},
                 {0.1f, {45.8, 30.4, 66.6}},
                 {0.2f, {27.8, 29.2, 40.1}},
                 {0.4f, {16.3, 14.0, 20.4}},
                 {0.8f, {14.4, 7.2, 17.1}}};
    const auto& library = shippedMaterials();
    for (const auto& film : films) {
        EXPECT_LE(deltaE2000(bodyLab({&library.at("copper"), &library.at("cuprite")}, {film.thicknessUm}), film.lab),
                  0.5)
            << film.thicknessUm << " µm";
    }
}

TEST(PatinaColours, antleriteOverCupriteTurnsGreenAsMeasuredPowdersSay) {
    const auto file = test::sharedData() / "spectra/aster_v2/antlerite_fine.csv";
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "the antlerite measurement is not here; it may not be shipped";
    }
    const FineSpectrum measured = readSpectrumFile(file, "reflectance", {}).fine();
    const auto& library = shippedMaterials();
    Material antlerite = library.at("antlerite");
    for (int i = 0; i < fineCount; ++i) {
        antlerite.fineScattering[i] = 0.25;
        antlerite.fineAbsorption[i] = 0.25 * absorptionOverScattering(measured[i]);
    }
    antlerite.absorption = atBands(antlerite.fineAbsorption);
    antlerite.scattering = atBands(antlerite.fineScattering);
    const struct {
        float thicknessUm;
        V3d lab;
    } films[] = {
        {1.f, {50.3, -7.5, 1.3}}, {3.f, {64.1, -19.6, 1.7}}, {6.f, {69.2, -27.7, 3.3}}, {12.f, {70.9, -31.7, 4.7}}};
    for (const auto& film : films) {
        const V3d lab = bodyLab({&library.at("copper"), &library.at("cuprite"), &antlerite}, {1.f, film.thicknessUm});
        EXPECT_LE(deltaE2000(lab, film.lab), 1.0) << film.thicknessUm << " µm";
    }
    // The shipped constants carry the interface apart; an opaque layer in air is the powder that was measured.
    const V3d shipped = test::labOf(library.at("antlerite").swatch);
    EXPECT_LE(deltaE2000(shipped, labFromXyz(xyzFromReflectance(measured))), 0.5);
}

// Leygraf et al. 2019: brown-black is reached at 0.8 ± 0.2 µm of cuprite, and 12 ± 2 µm of green hide it.
// Hidden: within 2.3, a just noticeable difference of two surfaces side by side (Mahy et al. 1994 find 2.3 in ΔE).
TEST(PatinaColours, filmsHideWhatLiesBelowAtTheThicknessesReported) {
    const V3d endlessBrown = test::labOf(test::total(look({"copper", "cuprite"}, {50.f})));
    EXPECT_LE(deltaE2000(test::labOf(test::total(look({"copper", "cuprite"}, {0.8f}))), endlessBrown), 2.3);
    EXPECT_GE(deltaE2000(test::labOf(test::total(look({"copper", "cuprite"}, {0.25f}))), endlessBrown), 2.3);
    for (const char* green : {"antlerite", "brochantite"}) {
        const V3d endless = test::labOf(test::total(look({"copper", "cuprite", green}, {1.f, 500.f})));
        const auto difference = [&](float d) {
            return deltaE2000(test::labOf(test::total(look({"copper", "cuprite", green}, {1.f, d}))), endless);
        };
        EXPECT_LE(difference(14.f), 2.3) << green;
        EXPECT_GE(difference(8.f), 2.3) << green;
    }
}

TEST(PatinaColours, coatingsOfThePapersScriptsReadBrownThenGreen) {
    const V3d brown = test::labOf(look({"copper", "tarnish_1", "cuprite_2"}, {0.35f, 1.2f}).diffuse);
    EXPECT_GT(brown.y, 0.0);
    EXPECT_GT(brown.z, 0.0);
    EXPECT_LT(brown.x, 30.0);
    const struct {
        std::vector<std::string> names;
        std::vector<float> thicknessUm;
    } stacks[] = {
        {{"copper", "tarnish_1", "cuprite_2", "marine_patina_3", "marine_patina_4"}, {0.35f, 1.2f, 3.f, 1.8f}},
        {{"copper", "tarnish_1", "cuprite_2", "rural_patina_3", "rural_patina_4"}, {0.25f, 1.f, 1.f, 1.1f}},
        {{"copper", "tarnish_1", "cuprite_urban_2", "patina_urban_3", "patina_urban_4"}, {0.55f, 1.f, 4.f, 3.f}}};
    for (const auto& stack : stacks) {
        const V3d green = test::labOf(test::total(look(stack.names, stack.thicknessUm)));
        EXPECT_LT(green.y, -5.0) << stack.names.back();
    }
}

/// What weathered copper roofs were measured to look like: L*a*b* (2 degrees, D65) computed from samples 0692UUUCOP and
/// 0682UUUCOP. Reproduced from the ASTER Spectral Library through the courtesy of the Jet Propulsion Laboratory,
/// California Institute of Technology, Pasadena, California. Copyright (c) 1999, California Institute of Technology.
/// ALL RIGHTS RESERVED. (Baldridge, Hook, Grove & Rivera 2009, Remote Sens. Environ. 113:711-715.)
const V3d tenYearRoof(51.3, 18.7, 32.5), oldRoof(67.9, -11.8, 6.4);

/// An environment as data/weather/copper_*.toml has it.
struct Environment {
    const char* name;
    const char *cuprite, *third, *fourth;
    double tarnishUm, tarnishYears, cupriteUm, cupriteYears;
};
const Environment environments[] = {
    {"marine", "cuprite_2", "marine_patina_3", "marine_patina_4", 0.35, 0.7, 0.8, 3.0},
    {"rural", "cuprite_2", "rural_patina_3", "rural_patina_4", 0.25, 1.0, 0.8, 5.0},
    {"urban", "cuprite_urban_2", "patina_urban_3", "patina_urban_4", 0.55, 0.5, 1.0, 2.0}};

/// ISO 9224: metal lost after t years, along the tangent from 20 years on. r: the geometric middle of the category in
/// ISO 9223, as docs/weather.md uses it.
double metalLostUm(double firstYearUm, double years) {
    constexpr double b = 0.667;
    const double at20 = std::pow(20.0, b);
    return firstYearUm * (years <= 20.0 ? std::pow(years, b) : at20 + b * at20 / 20.0 * (years - 20.0));
}
const double c2UmPerYear = std::sqrt(0.1 * 0.6), c3UmPerYear = std::sqrt(0.6 * 1.3);

/// The stack of docs/optics.md, section 5: four times the metal as mineral, half of it washed away; the oxides have
/// theirs first, the two mineral layers share the rest evenly.
V3d roofLab(const Environment& environment, double firstYearUm, double years) {
    const double whole = 0.5 * 4.0 * metalLostUm(firstYearUm, years);
    const double tarnish = environment.tarnishUm * (1.0 - std::exp(-years / environment.tarnishYears));
    const double cuprite = environment.cupriteUm * (1.0 - std::exp(-years / environment.cupriteYears));
    const float each = static_cast<float>(std::max(0.5 * (whole - tarnish - cuprite), 0.0));
    return test::labOf(
        test::total(look({"copper", "tarnish_1", environment.cuprite, environment.third, environment.fourth},
                         {static_cast<float>(tarnish), static_cast<float>(cuprite), each, each})));
}

TEST(PatinaColours, aThirtyYearOldPatinaLooksLikeTheMeasuredRoof) {
    for (const Environment& environment : environments) {
        const V3d lab = roofLab(environment, c3UmPerYear, 30.0);
        EXPECT_LE(deltaE2000(lab, oldRoof), 8.0) << environment.name << " " << lab;
        RecordProperty(std::string(environment.name) + "_delta_e", std::to_string(deltaE2000(lab, oldRoof)));
    }
    EXPECT_LE(deltaE2000(roofLab(environments[1], c2UmPerYear, 30.0), oldRoof), 8.0); // the country is C2
}

// What holds of the other roof, ten years old and still brown: it is copper under cuprite of a fifteenth to a tenth of
// a micrometre. So little comes only of the driest air: cuprite is 1.68 times the metal, so that film is 0.04 … 0.06 µm
// of copper in ten years and r = 0.008 … 0.014 µm a year, inside C1 (up to 0.1).
TEST(PatinaColours, theTenYearOldRoofIsAThinFilmOfCuprite) {
    double best = 1e9;
    for (double um = 0.065; um < 0.1; um += 0.005) {
        const double difference =
            deltaE2000(test::labOf(test::total(look({"copper", "cuprite_2"}, {static_cast<float>(um)}))), tenYearRoof);
        EXPECT_LE(difference, 10.0) << um;
        best = std::min(best, difference);
    }
    EXPECT_LE(best, 7.5);
    for (const double um : {0.065, 0.1}) {
        const double firstYearUm = um / 1.68 / metalLostUm(1.0, 10.0);
        EXPECT_GT(firstYearUm, 0.0);
        EXPECT_LT(firstYearUm, 0.1);
    }
}

// What does not hold: the kinetics of an ordinary place, C2 and above, make ten years more than half a micrometre of
// oxide and some green, darker or greener than that roof by far. This asserts the failure, so that whoever mends it
// finds the sentence in docs/optics.md that says so.
TEST(PatinaColours, tenYearsOfOrdinaryKineticsAreNotThatRoof) {
    for (const Environment& environment : environments) {
        for (const double rate : {c2UmPerYear, c3UmPerYear}) {
            EXPECT_GT(deltaE2000(roofLab(environment, rate, 10.0), tenYearRoof), 10.0) << environment.name;
        }
    }
}

} // namespace
} // namespace patina
