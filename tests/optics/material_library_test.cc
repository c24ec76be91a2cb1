#include "base/errors.h"
#include "optics/material_library.h"
#include "optics_test_support.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace patina {
namespace {

using test::shippedMaterials;
using ::testing::HasSubstr;

TEST(MaterialLibrary, shipsEveryMaterialOfThePaper) {
    for (const char* name : {"copper",
                             "tarnish_1",
                             "cuprite_2",
                             "marine_patina_3",
                             "marine_patina_4",
                             "rural_patina_3",
                             "rural_patina_4",
                             "cuprite_urban_2",
                             "patina_urban_3",
                             "patina_urban_4",
                             "dirt",
                             "cuprite",
                             "tenorite",
                             "copper_sulphide",
                             "posnjakite",
                             "atacamite",
                             "brochantite",
                             "antlerite",
                             "malachite",
                             "organic_binder",
                             "soot",
                             "azurite",
                             "verdigris",
                             "wax",
                             "lacquer",
                             "bronze",
                             "brass",
                             "iron",
                             "steel",
                             "zinc",
                             "silver",
                             "gold",
                             "aluminium",
                             "lead",
                             "goethite",
                             "lepidocrocite",
                             "hematite",
                             "magnetite",
                             "zinc_oxide",
                             "zinc_carbonate",
                             "gibbsite",
                             "silver_sulphide"}) {
        EXPECT_NE(shippedMaterials().find(name), nullptr) << name;
    }
    EXPECT_EQ(shippedMaterials().find("cuprit"), nullptr);
    try {
        shippedMaterials().at("cuprit");
        FAIL();
    } catch (const RunError& error) {
        EXPECT_THAT(error.remedy(), HasSubstr("cuprite"));
    }
}

TEST(MaterialLibrary, everyShippedMaterialIsPhysicalAndNamesItsSource) {
    for (const std::string& name : shippedMaterials().names()) {
        const Material& material = shippedMaterials().at(name);
        EXPECT_GT(material.source.size(), 40u) << name;
        EXPECT_FALSE(material.title.empty()) << name;
        EXPECT_TRUE(material.roughness > 0.f && material.roughness <= 1.f) << name;
        EXPECT_TRUE(material.density > 0.f && material.density <= 1.f) << name;
        EXPECT_GT(material.hardness, 0.f) << name;
        for (int band = 0; band < bandCount; ++band) {
            EXPECT_TRUE(material.reflectance[band] >= 0.f && material.reflectance[band] <= 1.f) << name;
            EXPECT_TRUE(material.absorption[band] >= 0.f && material.absorption[band] < 200.f) << name;
            // Finely divided pigments of the highest index reach a few per µm.
            EXPECT_TRUE(material.scattering[band] >= 0.f && material.scattering[band] < 3.f) << name;
            EXPECT_TRUE(material.isMetal || material.scattering[band] > 0.f) << name;
        }
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(material.swatch[c] >= 0.f && material.swatch[c] <= 1.f) << name;
            EXPECT_TRUE(material.specularColour[c] >= 0.f && material.specularColour[c] <= 1.f) << name;
        }
    }
}

TEST(MaterialLibrary, anOpaqueLayerLooksLikeThePowderThatWasMeasured) {
    const auto file = std::filesystem::path(PATINA_SOURCE_DIR) / "data/spectra/usgs/malachite_GDS801_synthetic_asd.csv";
    const FineSpectrum measured = readSpectrumFile(file, "reflectance", {}).fine();
    const Imath::V3f swatch = shippedMaterials().at("malachite").swatch;
    EXPECT_LE(deltaE2000(test::labOf(swatch), labFromXyz(xyzFromReflectance(measured))), 0.05);
}

TEST(MaterialLibrary, mixturesFollowDuncansRule) {
    const auto& library = shippedMaterials();
    const Material& tarnish = library.at("tarnish_1");
    const Material& cuprite = library.at("cuprite");
    const Material& sulphide = library.at("copper_sulphide");
    for (int i = 0; i < fineCount; ++i) {
        EXPECT_NEAR(tarnish.fineAbsorption[i], 0.85 * cuprite.fineAbsorption[i] + 0.15 * sulphide.fineAbsorption[i],
                    1e-9 * cuprite.fineAbsorption[i]);
        EXPECT_NEAR(tarnish.fineScattering[i], 0.85 * cuprite.fineScattering[i] + 0.15 * sulphide.fineScattering[i],
                    1e-9);
    }
}

TEST(MaterialLibrary, aMixtureHasTheMeanDensityOfItsParts) {
    const auto& library = shippedMaterials();
    EXPECT_NEAR(library.at("tarnish_1").densityKgPerM3,
                0.85f * library.at("cuprite").densityKgPerM3 + 0.15f * library.at("copper_sulphide").densityKgPerM3,
                1.f);
    for (const std::string& name : library.names()) {
        EXPECT_GT(library.at(name).densityKgPerM3, 0.f) << name;
    }
}

// Where the roughness or the scattering is an estimate, the flag says so: no file claims to be measured throughout.
TEST(MaterialLibrary, whatIsCalledAnEstimateInTheSourceIsFlagged) {
    for (const std::string& name : shippedMaterials().names()) {
        const Material& material = shippedMaterials().at(name);
        if (material.source.find("stimate") != std::string::npos) {
            EXPECT_TRUE(material.isEstimate) << name;
        }
    }
}

/// A data folder of its own for broken files.
class BrokenMaterials : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(::testing::TempDir()) /
                  ("patina_materials_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_ / "materials");
        std::filesystem::create_directories(folder_ / "spectra");
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }

    /// The first finding of loading the folder.
    Diagnostic finding() {
        try {
            MaterialLibrary::load(folder_);
        } catch (const ScriptError& error) {
            return error.diagnostics().at(0);
        }
        ADD_FAILURE() << "the folder loaded";
        return {};
    }

    void expectFinding(const std::string& file, int line, int column, const std::string& message) {
        const Diagnostic found = finding();
        EXPECT_EQ(std::filesystem::path(found.place.file).filename(), file);
        EXPECT_EQ(found.place.line, line) << found.text();
        EXPECT_EQ(found.place.column, column) << found.text();
        EXPECT_THAT(found.message, HasSubstr(message));
    }

    std::filesystem::path folder_;
};

const char* const goodFilm = "source = \"test\"\n"
                             "[reflectance]\n"
                             "wavelengths_nm = [400, 480, 560, 640, 700]\n"
                             "values = [0.2, 0.3, 0.4, 0.3, 0.2]\n"
                             "[scattering]\n"
                             "value = 250\n"
                             "unit = \"1/mm\"\n";

TEST_F(BrokenMaterials, aGoodFileLoadsAndItsUnitIsConverted) {
    write("materials/green.toml", goodFilm);
    const MaterialLibrary library = MaterialLibrary::load(folder_);
    EXPECT_NEAR(library.at("green").scattering[3], 0.25f, 1e-6f);
}

TEST_F(BrokenMaterials, scatteringFollowsFromTheThicknessThatHides) {
    std::string text = goodFilm;
    text.replace(text.find("value = 250"), std::string::npos, "hides_at_um = 12\n");
    write("materials/green.toml", text);
    const MaterialLibrary library = MaterialLibrary::load(folder_);
    const Material& green = library.at("green");
    double contrast[2];
    for (int white = 0; white < 2; ++white) {
        FineSpectrum seen;
        for (int i = 0; i < fineCount; ++i) {
            seen[i] = overBackground(kubelkaMunkLayer(green.fineAbsorption[i], green.fineScattering[i], 12.0),
                                     static_cast<double>(white));
        }
        contrast[white] = xyzFromReflectance(seen).y;
    }
    EXPECT_NEAR(contrast[0] / contrast[1], 0.98, 1e-6);
}

TEST_F(BrokenMaterials, spectrumOutOfOrder) {
    std::string text = goodFilm;
    text.replace(text.find("480, 560"), 8, "560, 480");
    write("materials/green.toml", text);
    expectFinding("green.toml", 3, 29, "wavelengths must rise, but 480 nm follows 560 nm"); // the 480 itself
}

TEST_F(BrokenMaterials, spectrumWithAGap) {
    write("spectra/gap.csv", "# measured\nwavelength_nm,reflectance\n400,0.1\n420,0.1\n600,0.2\n700,0.2\n");
    write("materials/green.toml",
          "source = \"test\"\n[reflectance]\nfile = \"spectra/gap.csv\"\n[scattering]\nhides_at_um = 3\n");
    expectFinding("gap.csv", 5, 1, "a gap from 420 to 600 nm");
}

TEST_F(BrokenMaterials, spectrumOutOfOrderInItsFile) {
    write("spectra/order.csv", "wavelength_nm,reflectance\n400,0.1\n500,0.1\n450,0.2\n700,0.2\n");
    write("materials/green.toml",
          "source = \"test\"\n[reflectance]\nfile = \"spectra/order.csv\"\n[scattering]\nhides_at_um = 3\n");
    expectFinding("order.csv", 4, 1, "wavelengths must rise, but 450 nm follows 500 nm");
}

TEST_F(BrokenMaterials, aPlaceInAFileIsThatOfTheNumberAtFault) {
    const char* const toml =
        "source = \"test\"\n[reflectance]\nfile = \"spectra/it.csv\"\n[scattering]\nhides_at_um = 3\n";
    write("materials/green.toml", toml);
    const std::string head = "# measured\nreflectance, wavelength_nm\n";
    write("spectra/it.csv", head + "0.1, 400\n0.1, 500\n0.2, 450\n0.2, 700\n");
    expectFinding("it.csv", 5, 6, "wavelengths must rise");
    write("spectra/it.csv", head + "0.1, 400\n0.1, 500\n 1.2, 600\n0.2, 700\n");
    expectFinding("it.csv", 5, 2, "reflectance 1.2 is outside 0…1");
    write("spectra/it.csv", head + "0.1, 500\n0.1, 550\n 0.2, 630\n0.2, 700\n");
    expectFinding("it.csv", 3, 6, "must span at least 440…690 nm");
    write("spectra/it.csv", head);
    expectFinding("it.csv", 2, 1, "the table has no samples");
    write("spectra/it.csv", "wavelength_nm, R\n400, 0.1\n700, 0.1\n");
    expectFinding("it.csv", 1, 1, "no column 'reflectance'");
}

TEST_F(BrokenMaterials, spectrumWithAWordForANumber) {
    write("spectra/word.csv", "wavelength_nm,reflectance\n400,0.1\n450, n/a\n");
    write("materials/green.toml",
          "source = \"test\"\n[reflectance]\nfile = \"spectra/word.csv\"\n[scattering]\nhides_at_um = 3\n");
    expectFinding("word.csv", 3, 6, "expected a number, found 'n/a'");
}

TEST_F(BrokenMaterials, spectrumTooShort) {
    std::string text = goodFilm;
    text.replace(text.find("640, 700"), 8, "610, 640");
    write("materials/green.toml", text);
    expectFinding("green.toml", 3, 39, "must span at least 440…690 nm"); // the last, 640
}

TEST_F(BrokenMaterials, reflectanceAboveOne) {
    std::string text = goodFilm;
    text.replace(text.find("0.4"), 3, "40.");
    text.replace(text.find("40."), 3, "4.0");
    write("materials/green.toml", text);
    expectFinding("green.toml", 4, 21, "reflectance 4 is outside 0…1");
}

TEST_F(BrokenMaterials, unknownUnit) {
    std::string text = goodFilm;
    text.replace(text.find("1/mm"), 4, "1/ft");
    write("materials/green.toml", text);
    expectFinding("green.toml", 7, 8, "unknown unit '1/ft'");
}

TEST_F(BrokenMaterials, unknownKey) {
    write("materials/green.toml", std::string("rougness = 0.2\n") + goodFilm);
    const Diagnostic found = finding();
    EXPECT_EQ(found.place.line, 1);
    EXPECT_EQ(found.place.column, 1);
    EXPECT_EQ(found.message, "unknown key 'rougness'");
    EXPECT_THAT(found.remedy, HasSubstr("roughness"));
    EXPECT_EQ(found.sourceLine, "rougness = 0.2");
}

TEST_F(BrokenMaterials, missingSpectrumFile) {
    write("materials/green.toml",
          "source = \"test\"\n[reflectance]\nfile = \"spectra/nowhere.csv\"\n[scattering]\nhides_at_um = 3\n");
    expectFinding("green.toml", 3, 8, "no such spectrum file 'spectra/nowhere.csv'");
}

TEST_F(BrokenMaterials, mixtureThatNamesItself) {
    write("materials/mix.toml", "source = \"test\"\n[mixture]\nparts = [{ material = \"mix\", volume = 1.0 }]\n");
    expectFinding("mix.toml", 3, 23, "mixture 'mix' names itself");
}

TEST_F(BrokenMaterials, mixturesThatContainEachOther) {
    write("materials/a.toml", "source = \"test\"\n[mixture]\nparts = [{ material = \"b\", volume = 1.0 }]\n");
    write("materials/b.toml", "source = \"test\"\n[mixture]\nparts = [{ material = \"a\", volume = 1.0 }]\n");
    expectFinding("b.toml", 3, 23, "contains 'a', which contains it");
}

TEST_F(BrokenMaterials, mixtureOfAnUnknownMaterial) {
    write("materials/green.toml", goodFilm);
    write("materials/mix.toml", "source = \"test\"\n[mixture]\nparts = [{ material = \"gren\", volume = 1.0 }]\n");
    const Diagnostic found = finding();
    EXPECT_EQ(found.message, "unknown material 'gren'");
    EXPECT_THAT(found.remedy, HasSubstr("green"));
}

TEST_F(BrokenMaterials, mixtureWhoseVolumesDoNotAddUp) {
    write("materials/green.toml", goodFilm);
    write("materials/mix.toml", "source = \"test\"\n[mixture]\nparts = [{ material = \"green\", volume = 0.7 }]\n");
    expectFinding("mix.toml", 3, 9, "must add up to 1, these give 0.7");
}

TEST_F(BrokenMaterials, notToml) {
    write("materials/green.toml", "title = \"no end\nsource = 3\n");
    const Diagnostic found = finding();
    EXPECT_EQ(found.place.line, 1);
    EXPECT_FALSE(found.message.empty());
}

TEST_F(BrokenMaterials, noSourceNoOpticsAndAWrongTypeAreAllReportedAtOnce) {
    write("materials/a.toml", "title = 3\nroughness = \"much\"\n");
    write("materials/b.toml", "source = \"test\"\nkind = \"metal\"\n");
    try {
        MaterialLibrary::load(folder_);
        FAIL();
    } catch (const ScriptError& error) {
        EXPECT_GE(error.diagnostics().size(), 4u);
        EXPECT_EQ(error.code(), ExitCode::script);
    }
}

TEST(MaterialLibraryFolder, missingFolderIsARunError) {
    EXPECT_THROW(MaterialLibrary::load("/nowhere/at/all"), RunError);
}

} // namespace
} // namespace patina
