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

// AP1's primaries (S-2014-004) are the corners of ACEScg; seen under D65 they are Bradford's image of them. Adapting
// back by the same cone responses must give the published chromaticities.
TEST(Colour, primariesOfAcescgAreThoseOfAp1) {
    const double chromaticities[3][2] = {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}};
    const double bradford[3][3] = {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}};
    const auto cones = [&](const V3d& xyz) {
        V3d result;
        for (int row = 0; row < 3; ++row) {
            result[row] = bradford[row][0] * xyz.x + bradford[row][1] * xyz.y + bradford[row][2] * xyz.z;
        }
        return result;
    };
    const V3d acesWhite(0.32168 / 0.33767, 1.0, (1.0 - 0.32168 - 0.33767) / 0.33767);
    const V3d from = cones(whiteD65()), to = cones(acesWhite);
    for (int c = 0; c < 3; ++c) {
        V3d one(0.0);
        one[c] = 1.0;
        EXPECT_NEAR((acescgFromXyz(xyzFromAcescg(one)) - one).length(), 0.0, 1e-12);
        const V3d underD65 = cones(xyzFromAcescg(one));
        const double x = chromaticities[c][0], y = chromaticities[c][1];
        const V3d published = cones({x / y, 1.0, (1.0 - x - y) / y});
        // Equal up to brightness: the cone responses keep their ratios.
        const double scale = underD65.x * to.x / from.x / published.x;
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(underD65[k] * to[k] / from[k], scale * published[k], 1e-9 * scale);
        }
    }
}

// The matrix from linear sRGB to ACEScg with Bradford's adaptation, as the ACES documentation prints it.
TEST(Colour, acescgOfRec709IsThePublishedMatrix) {
    const double published[3][3] = {
        {0.613097, 0.339523, 0.047379}, {0.070194, 0.916354, 0.013452}, {0.020616, 0.109570, 0.869815}};
    for (int column = 0; column < 3; ++column) {
        V3d one(0.0);
        one[column] = 1.0;
        const V3d aces = acescgFromXyz(xyzFromLinearRec709(one));
        for (int row = 0; row < 3; ++row) {
            EXPECT_NEAR(aces[row], published[row][column], 2e-4);
        }
    }
}

// What a bake in ACEScg writes is what one in Rec.709 writes, converted, wherever Rec.709 has room for the colour.
TEST(Colour, aStackInAcescgIsTheSameStackConverted) {
    test::Uniforms uniforms("acescg");
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
        const test::RandomStack stack = test::randomStack(uniforms);
        const StackOptics optics(stack.materials);
        Appearance rec709, acescg;
        optics.evaluate(stack.thicknessUm.data(), rec709);
        optics.in(ColourSpace::acescg).evaluate(stack.thicknessUm.data(), acescg);
        const auto compare = [&](const Imath::V3f& a, const Imath::V3f& b, const char* what) {
            if (a.x <= 0.f || a.y <= 0.f || a.z <= 0.f) {
                return; // clipped
            }
            const V3d converted = acescgFromXyz(xyzFromLinearRec709(V3d(a)));
            EXPECT_NEAR((converted - V3d(b)).length(), 0.0, 1e-5) << what << " " << i;
            ++compared;
        };
        const Imath::V3f sum = test::total(rec709);
        if (std::max({sum.x, sum.y, sum.z}) < 0.99f) {
            compare(rec709.diffuse, acescg.diffuse, "diffuse");
            const Imath::V3f air(rec709.lobes[0].air); // added after clipping
            compare(rec709.lobes[0].colour - air, acescg.lobes[0].colour - air, "metal");
        }
    }
    EXPECT_GT(compared, 1500);
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
