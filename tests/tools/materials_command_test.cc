// vdb-patina materials: the list, one in detail with its swatch, fits, and what is wrong with a material's file.

#include "program.h"

#include "optics/kubelka_munk.h"
#include "render/film.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

namespace patina {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Of swatch.cc's layout: strips begin at 45 and follow each other every 130 rows; colour from 24 to 80, then ticks and
// labels up to 120.
constexpr int firstStrip = 45, nextStrip = 130, colourRow = 24 + 28, labelRow = 24 + 56 + 6;

int darkPixels(const Image& image, int firstRow, int lastRow) {
    int count = 0;
    for (int y = firstRow; y < lastRow; ++y)
        for (int x = 0; x < image.width; ++x)
            count += image.rgb(x, y).y < 0.5f ? 1 : 0;
    return count;
}

TEST(MaterialsCommand, DrawsASwatchThatEndsInTheOpaqueColour) {
    const test::TemporaryFolder folder;
    const auto outcome = test::vdbPatina({"materials", "brochantite", "-o", "."}, folder.path());
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("specular colour 0.028 0.028 0.028"), HasSubstr("3970 kg/m³"),
                                   HasSubstr("source: "), HasSubstr("K/(1/µm)")));
    const Image swatch = readPng(folder.path() / "brochantite_swatch.png");
    ASSERT_EQ(swatch.width, 760);
    // The first strip: copper on the left, green on the right.
    const int row = firstStrip + colourRow;
    const Imath::V3f left = swatch.rgb(26, row), right = swatch.rgb(760 - 26, row);
    EXPECT_GT(left.x, left.y);
    EXPECT_GT(right.y, right.x);
    // The second: dark cuprite on the left, the same green on the right, where it is opaque.
    const Imath::V3f dark = swatch.rgb(26, row + nextStrip), green = swatch.rgb(760 - 26, row + nextStrip);
    EXPECT_LT(dark.x + dark.y + dark.z, 0.6f * (left.x + left.y + left.z));
    EXPECT_NEAR((green - right).length(), 0.f, 0.03f); // each within a CIEDE2000 of 1 of the endless layer
    if (!outcome.saysOnError("no font")) { // titles and thicknesses are written
        for (const int strip : {firstStrip, firstStrip + nextStrip}) {
            EXPECT_GT(darkPixels(swatch, strip, strip + 22), 50);
            EXPECT_GT(darkPixels(swatch, strip + labelRow + 6, strip + labelRow + 30), 50);
        }
    }
    EXPECT_EQ(test::vdbPatina({"materials", "copper", "-o", "."}, folder.path()).exitCode, 0);
    EXPECT_EQ(test::vdbPatina({"materials", "brochantite", "--over", "copper"}, folder.path()).exitCode, 2);
    EXPECT_THAT(test::vdbPatina({"materials", "brochantit"}, folder.path()).err,
                HasSubstr("did you mean 'brochantite'?"));
}

/// Samples of a layer whose K and S are known.
class MaterialsFit : public testing::Test {
  protected:
    static double absorption(double nm) { return 0.02 + 1.5 * std::exp(-std::pow((nm - 480.0) / 60.0, 2)); }
    static constexpr double scattering = 0.5;

    std::string sample(const char* name, double um, double backing) const {
        std::string text = "# made by Kubelka and Munk\nwavelength_nm,reflectance\n";
        for (int nm = 400; nm <= 700; nm += 20)
            text += std::to_string(nm) + "," +
                    std::to_string(overBackground(kubelkaMunkLayer(absorption(nm), scattering, um), backing)) + "\n";
        return folder.file(name, text);
    }
    /// Runs a fit whose material is then loaded by the program itself. \return what `materials mine` says
    std::string fitted(test::Arguments arguments) const {
        arguments.insert(arguments.begin(), {"materials", "fit", "--body", "--name", "mine", "-o", "data/materials"});
        std::filesystem::create_directories(folder.path() / "data/materials");
        const auto outcome = test::vdbPatina(arguments, folder.path());
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_TRUE(std::filesystem::exists(folder.path() / "data/materials/mine.toml"));
        return outcome.out;
    }
    /// K and S at a wavelength out of the fit's table.
    static std::pair<double, double> at(const std::string& table, int nm) {
        const std::size_t place = table.find("           " + std::to_string(nm) + " ");
        EXPECT_NE(place, std::string::npos) << table;
        int read = 0;
        double k = 0.0, s = 0.0;
        std::sscanf(table.c_str() + place, "%d %lf %lf", &read, &k, &s);
        EXPECT_EQ(read, nm);
        return {k, s};
    }
    void expectTheTruth(const std::string& table, double tolerance) const {
        for (const int nm : {400, 480, 560, 700}) {
            const auto [k, s] = at(table, nm);
            EXPECT_NEAR(k, absorption(nm), tolerance) << nm;
            EXPECT_NEAR(s, scattering, tolerance) << nm;
        }
    }

    const test::TemporaryFolder folder;
};

// The samples have six digits, the tables four.
TEST_F(MaterialsFit, TwoBackingsGiveBoth) {
    const std::string black = sample("black.csv", 2.0, 0.0), grey = sample("grey.csv", 2.0, 0.8);
    expectTheTruth(fitted({"--layer", black, "--thickness", "2", "--second", grey, "--second-backing", "0.8"}), 2e-4);
}

TEST_F(MaterialsFit, AnOpaqueAndAThinSampleGiveBoth) {
    const std::string opaque = sample("opaque.csv", 1e6, 0.0), thin = sample("thin.csv", 0.7, 0.6);
    expectTheTruth(fitted({"--opaque", opaque, "--layer", thin, "--thickness", "0.7", "--backing", "0.6"}), 2e-4);
}

TEST_F(MaterialsFit, AnOpaqueSampleGivesAbsorptionForAnAssumedScattering) {
    const std::string opaque = sample("opaque.csv", 1e6, 0.0);
    const std::string table = fitted({"--opaque", opaque, "--scattering", "0.25"});
    for (const int nm : {400, 480, 560, 700}) {
        EXPECT_NEAR(at(table, nm).first, 0.5 * absorption(nm), 2e-4) << nm;
        EXPECT_EQ(at(table, nm).second, 0.25);
    }
}

TEST_F(MaterialsFit, RefusesWhatIsNoSampleWithItsPlace) {
    const std::string grey = sample("grey.csv", 2.0, 0.8);
    folder.file("order.csv", "wavelength_nm,reflectance\n400,0.1\n500,0.1\n450,0.2\n700,0.2\n");
    folder.file("bright.csv", "wavelength_nm,reflectance\n400,0.1\n480,0.1\n560, 1.2\n640,0.2\n700,0.2\n");
    folder.file("word.csv", "wavelength_nm,reflectance\n400,0.1\n480,dark\n");
    folder.file("column.csv", "wavelength_nm,R\n400,0.1\n700,0.1\n");
    folder.file("empty.csv", "");
    const std::pair<const char*, const char*> cases[] = {
        {"missing.csv", "missing.csv: error: no such spectrum file"},
        {"order.csv", "order.csv:4:1: error: wavelengths must rise"},
        {"bright.csv", "bright.csv:4:6: error: reflectance 1.2 is outside"},
        {"word.csv", "word.csv:3:5: error: expected a number, found 'dark'"},
        {"column.csv", "column.csv:1:1: error: no column 'reflectance'"},
        {"empty.csv", "empty.csv:1:1: error: the table has no samples"}};
    std::vector<test::Arguments> lines;
    for (const auto& [file, message] : cases)
        lines.push_back({"materials", "fit", "--opaque", file, "--scattering", "0.3"});
    lines.push_back({"materials", "fit", "--layer", grey, "--thickness", "2", "--second", "missing.csv",
                     "--second-backing", "0.5"});
    lines.push_back(
        {"materials", "fit", "--layer", grey, "--thickness", "2", "--second", grey, "--second-backing", "missing.csv"});
    lines.push_back({"materials", "fit", "--layer", grey, "--thickness", "2", "--second", grey, "--second-backing", "0",
                     "--body"}); // as bright over black as over black
    const auto outcomes = test::vdbPatinaEach(lines, folder.path());
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(outcomes[i].exitCode, 3) << outcomes[i].err;
        EXPECT_EQ(outcomes[i].out, "");
        if (i < std::size(cases)) {
            EXPECT_THAT(outcomes[i].err, HasSubstr(cases[i].second));
        }
    }
    EXPECT_THAT(outcomes[6].err, HasSubstr("missing.csv: error: no such spectrum file"));
    EXPECT_THAT(outcomes[7].err, HasSubstr("missing.csv: error: no such spectrum file"));
    EXPECT_THAT(outcomes[8].err, HasSubstr("backings are too alike"));
    EXPECT_EQ(test::vdbPatina({"materials", "fit"}, folder.path()).exitCode, 2);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "fitted.toml"));
}

/// A folder of materials with one that is broken, given to the program as its data.
class BrokenMaterialFile : public testing::Test {
  protected:
    BrokenMaterialFile() {
        std::filesystem::create_directories(folder.path() / "data/materials");
        std::filesystem::create_directories(folder.path() / "data/spectra");
        ::setenv("PATINA_TEST_DATA", folder.at("data").c_str(), 1);
    }
    ~BrokenMaterialFile() override { ::unsetenv("PATINA_TEST_DATA"); }

    void expectError(const std::string& place, const std::string& message) const {
        const auto outcome = test::vdbPatina({"materials"}, folder.path());
        EXPECT_EQ(outcome.exitCode, 3);
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr(place + ": error: "));
        EXPECT_THAT(outcome.err, HasSubstr(message));
    }
    void write(const std::string& reflectance, const std::string& unit = "1/um") const {
        folder.file("data/materials/it.toml", "source = \"test\"\n[reflectance]\n" + reflectance +
                                                  "\n[scattering]\nvalue = 0.3\nunit = \"" + unit + "\"\n");
    }

    const test::TemporaryFolder folder;
};

TEST_F(BrokenMaterialFile, ASoundOneIsListed) {
    write("wavelengths_nm = [400, 480, 560, 640, 700]\nvalues = [0.2, 0.3, 0.4, 0.3, 0.2]");
    const auto outcome = test::vdbPatina({"materials"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("it "));
}

TEST_F(BrokenMaterialFile, ASpectrumOutOfOrderIsShownAtItsWavelength) {
    write("wavelengths_nm = [400, 560, 480, 640, 700]\nvalues = [0.2, 0.3, 0.4, 0.3, 0.2]");
    expectError("it.toml:3:29", "wavelengths must rise, but 480 nm follows 560 nm\n"
                                "    wavelengths_nm = [400, 560, 480, 640, 700]\n"
                                "                                ^");
}

TEST_F(BrokenMaterialFile, AGapInASpectrum) {
    write("wavelengths_nm = [400, 480, 640, 700]\nvalues = [0.2, 0.3, 0.3, 0.2]");
    expectError("it.toml:3:29", "a gap from 480 to 640 nm");
}

TEST_F(BrokenMaterialFile, AReflectanceOutsideZeroToOne) {
    write("wavelengths_nm = [400, 480, 560, 640, 700]\nvalues = [0.2, -0.3, 0.4, 0.3, 0.2]");
    expectError("it.toml:4:16", "reflectance -0.3 is outside 0…1");
}

TEST_F(BrokenMaterialFile, AnUnknownUnit) {
    write("wavelengths_nm = [400, 480, 560, 640, 700]\nvalues = [0.2, 0.3, 0.4, 0.3, 0.2]", "1/ft");
    expectError("it.toml:7:8", "unknown unit '1/ft'");
}

TEST_F(BrokenMaterialFile, AMissingFileAndAFaultInOneThatIsThere) {
    write("file = \"spectra/nowhere.csv\"");
    expectError("it.toml:3:8", "no such spectrum file 'spectra/nowhere.csv'");
    folder.file("data/spectra/there.csv", "wavelength_nm,reflectance\n400,0.1\n390,0.1\n");
    write("file = \"spectra/there.csv\"");
    expectError("there.csv:3:1", "wavelengths must rise, but 390 nm follows 400 nm");
}

TEST_F(BrokenMaterialFile, AMixtureThatNamesItself) {
    folder.file("data/materials/mix.toml",
                "source = \"test\"\n[mixture]\nparts = [{ material = \"mix\", volume = 1.0 }]\n");
    expectError("mix.toml:3:23", "mixture 'mix' names itself");
}

} // namespace
} // namespace patina
