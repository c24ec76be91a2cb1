// The inverse of Kubelka–Munk: coefficients come back from the reflectances they make.

#include "optics/material_fit.h"

#include "base/errors.h"
#include "optics/kubelka_munk.h"
#include "optics/material_library.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

namespace patina {
namespace {

using testing::HasSubstr;

const std::vector<double> wavelengths = {400, 450, 500, 550, 600, 650, 700};
double absorptionAt(double nm) {
    return 0.02 + 2.0 * std::exp(-std::pow((nm - 480.0) / 60.0, 2));
}
double scatteringAt(double nm) {
    return 0.5 * std::pow(550.0 / nm, 1.5);
}

MeasuredLayer layer(double thicknessUm, const std::function<double(double)>& backing) {
    MeasuredLayer made;
    made.name = "sample.csv";
    made.thicknessUm = thicknessUm;
    made.reflectance.wavelengthsNm = made.backing.wavelengthsNm = wavelengths;
    for (const double nm : wavelengths) {
        made.backing.values.push_back(backing(nm));
        made.reflectance.values.push_back(
            overBackground(kubelkaMunkLayer(absorptionAt(nm), scatteringAt(nm), thicknessUm), backing(nm)));
    }
    return made;
}
double black(double) {
    return 0.0;
}
double white(double nm) {
    return 0.92 - 1e-4 * (700.0 - nm);
}
double copper(double nm) {
    return nm > 580 ? 0.9 : 0.55;
}
MeasuredLayer opaque() {
    return layer(std::numeric_limits<double>::infinity(), black);
}

void expectTheTruth(const FittedCoefficients& fitted, double tolerance) {
    ASSERT_EQ(fitted.absorption.wavelengthsNm, wavelengths);
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
        EXPECT_NEAR(fitted.absorption.values[i] / absorptionAt(wavelengths[i]), 1.0, tolerance) << wavelengths[i];
        EXPECT_NEAR(fitted.scattering.values[i] / scatteringAt(wavelengths[i]), 1.0, tolerance) << wavelengths[i];
    }
}

TEST(MaterialFit, twoBackingsGiveBothCoefficients) {
    for (const double um : {0.3, 1.0, 2.0}) {
        expectTheTruth(fitTwoBackings(layer(um, black), layer(um, white)), 1e-6);
        expectTheTruth(fitTwoBackings(layer(um, copper), layer(um, white)), 1e-6);
    }
}

TEST(MaterialFit, anOpaqueAndAThinSampleGiveBothCoefficients) {
    for (const double um : {0.2, 1.0, 3.0})
        for (const auto& backing : {black, white, copper})
            expectTheTruth(fitOpaqueAndThin(opaque(), layer(um, backing)), 1e-6);
}

TEST(MaterialFit, anOpaqueSampleGivesAbsorptionForAnAssumedScattering) {
    const FittedCoefficients fitted = fitOpaque(opaque(), 0.25);
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
        EXPECT_EQ(fitted.scattering.values[i], 0.25);
        EXPECT_NEAR(fitted.absorption.values[i], 0.25 * absorptionAt(wavelengths[i]) / scatteringAt(wavelengths[i]),
                    1e-9);
    }
}

TEST(MaterialFit, refusesWhatNoLayerCanBe) {
    const auto message = [](const std::function<void()>& fit) {
        try {
            fit();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::script);
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(message([] { fitTwoBackings(layer(2, white), layer(2, white)); }), HasSubstr("backings are too alike"));
    EXPECT_THAT(message([] { fitTwoBackings(layer(2000, black), layer(2000, white)); }), HasSubstr("hides them"));
    EXPECT_THAT(message([] { fitOpaqueAndThin(opaque(), layer(2000, black)); }),
                HasSubstr("sample.csv: at 400 nm: the layer hides what is below"));
    EXPECT_THAT(message([] { fitOpaqueAndThin(opaque(), layer(1e-12, copper)); }),
                HasSubstr("as bright as its backing"));
    EXPECT_THAT(message([] { fitOpaqueAndThin(opaque(), opaque()); }), HasSubstr("thickness of this sample"));
    EXPECT_THAT(message([] { fitOpaque(opaque(), 0.0); }), HasSubstr("known scattering"));
    MeasuredLayer dark = layer(2, black), bright = layer(2, [](double) { return 0.9; });
    for (double& r : dark.reflectance.values)
        r = 0.3;
    for (double& r : bright.reflectance.values)
        r = 0.97; // brighter than what it lies on, by more than it scatters
    EXPECT_THAT(message([&] { fitTwoBackings(dark, bright); }), HasSubstr("no layer has these"));
}

TEST(MaterialFit, aFirstSurfaceIsTakenOffAsTheMaterialFilesDo) {
    // n = 1.5: a body of 0.5 looks like 0.31607 (TRUTHS, section 3).
    TabulatedSpectrum seen{{550}, {0.31607}};
    EXPECT_NEAR(bodyReflectance(seen, 1.5).values[0], 0.5, 1e-3);
    EXPECT_EQ(bodyReflectance({{550}, {0.01}}, 1.5).values[0], 0.0);
}

TEST(MaterialFit, writesAFileThatTheLibraryReads) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "materials");
    std::ofstream(folder.path() / "materials" / "mine.toml")
        << materialFileOf("mine", fitTwoBackings(layer(2, black), layer(2, white)), 1.5, "a \"test\"");
    const MaterialLibrary library = MaterialLibrary::load(folder.path());
    const Material& mine = library.at("mine");
    EXPECT_EQ(mine.source, "a \"test\"");
    for (int i = 0; i < fineCount; ++i)
        if (fineWavelengthNm(i) == 500.0) {
            EXPECT_NEAR(mine.fineAbsorption[i], absorptionAt(500.0), 1e-6);
            EXPECT_NEAR(mine.fineScattering[i], scatteringAt(500.0), 1e-6);
        }
}

} // namespace
} // namespace patina
