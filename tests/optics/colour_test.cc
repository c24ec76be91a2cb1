#include "optics/colour.h"
#include "optics_test_support.h"

#include <gtest/gtest.h>

#include <fstream>

namespace patina {
namespace {

using Imath::V3d;

TEST(Colour, whiteIsD65AndMapsToOne) {
    const V3d white = whiteD65();
    EXPECT_NEAR(white.x, 0.95047, 2e-5);
    EXPECT_NEAR(white.y, 1.0, 1e-12);
    EXPECT_NEAR(white.z, 1.08897, 5e-5);
    const V3d rgb = linearRec709FromXyz(white);
    const V3d banded = linearRec709(Spectrum::constant(0.25f));
    const V3d aces = acescgFromXyz(white);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(rgb[c], 1.0, 1e-12);
        EXPECT_NEAR(banded[c], 0.25, 1e-6);
        EXPECT_NEAR(aces[c], 1.0, 1e-4);
    }
}

TEST(Colour, primariesAreThoseOfRec709) {
    const V3d red = xyzFromLinearRec709({1, 0, 0});
    EXPECT_NEAR(red.x, 0.41239, 5e-5);
    EXPECT_NEAR(red.y, 0.21264, 5e-5);
    EXPECT_NEAR(red.z, 0.01933, 5e-5);
    const V3d back = linearRec709FromXyz(xyzFromLinearRec709({0.2, 0.7, 0.05}));
    EXPECT_NEAR((back - V3d(0.2, 0.7, 0.05)).length(), 0.0, 1e-12);
}

TEST(Colour, builtInTablesAreTheShippedFile) {
    std::ifstream file(std::filesystem::path(PATINA_SOURCE_DIR) / "data/cie/cie1931_2deg_d65_5nm.csv");
    ASSERT_TRUE(file);
    std::string line;
    int found = 0;
    while (std::getline(file, line)) {
        double nm, x, y, z, d65;
        if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &nm, &x, &y, &z, &d65) == 5 && nm >= 360) {
            const int i = static_cast<int>(std::lround((nm - 360) / 5));
            EXPECT_DOUBLE_EQ(cieTables().x[i], x);
            EXPECT_DOUBLE_EQ(cieTables().y[i], y);
            EXPECT_DOUBLE_EQ(cieTables().z[i], z);
            EXPECT_DOUBLE_EQ(cieTables().d65[i], d65);
            ++found;
        }
    }
    EXPECT_EQ(found, cieCount);
}

// Pairs of Sharma, Wu and Dalal 2005, table 1.
TEST(Colour, deltaE2000GivesThePublishedPairs) {
    const struct {
        V3d a, b;
        double difference;
    } pairs[] = {
        {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
        {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
        {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
        {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
        {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
    };
    for (const auto& pair : pairs) {
        EXPECT_NEAR(deltaE2000(pair.a, pair.b), pair.difference, 1e-4);
        EXPECT_NEAR(deltaE2000(pair.b, pair.a), pair.difference, 1e-4);
    }
}

TEST(Colour, srgbCurveRoundTripsAndClips) {
    for (double v : {0.0, 0.001, 0.0031308, 0.02, 0.5, 1.0}) {
        EXPECT_NEAR(decodeSrgb(encodeSrgb(v)), v, 1e-6);
    }
    EXPECT_NEAR(encodeSrgb(0.5), 0.735357, 1e-6);
    EXPECT_EQ(srgbHex({1.3, 0.5, -0.2}), "#ffbc00");
}

TEST(Colour, bandsAreWithinHalfADeltaEOfFiveNanometres) {
    test::Uniforms uniforms("bands");
    double worst = 0.0;
    for (int i = 0; i < 5000; ++i) {
        const test::RandomStack stack = test::randomStack(uniforms);
        const StackOptics optics(stack.materials);
        const V3d banded = labFromXyz(xyzFromReflectance(optics.bodyReflectance(stack.thicknessUm.data())));
        const V3d fine = labFromXyz(xyzFromReflectance(test::fineBody(stack.materials, stack.thicknessUm)));
        worst = std::max(worst, deltaE2000(banded, fine));
    }
    EXPECT_LE(worst, 0.5);
    RecordProperty("worst_delta_e", std::to_string(worst));
}

} // namespace
} // namespace patina
