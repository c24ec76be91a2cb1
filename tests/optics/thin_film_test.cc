// Interference against Fresnel's and Airy's closed forms, and its place in the stack.

#include "optics/thin_film.h"

#include "optics_test_support.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Complex = std::complex<double>;
using test::shippedMaterials;
using test::Uniforms;

const Complex copperIndex(0.6, 2.6), cupriteIndex(2.7, 0.15);

double fresnelAtNormal(Complex n, double outside = 1.0) {
    return std::norm((outside - n) / (outside + n));
}

Complex cosineIn(Complex n, double sine, double outside) {
    const Complex cosine = std::sqrt(1.0 - std::pow(outside * sine / n, 2));
    return (n * cosine).imag() < 0.0 ? -cosine : cosine;
}

// r = (r01 + r12 exp(2 i b)) / (1 + r01 r12 exp(2 i b)), one film (Airy); unpolarised.
double airy(Complex film, double um, Complex substrate, double nm, double cosine, double outside) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const Complex c[3] = {cosine, cosineIn(film, sine, outside), cosineIn(substrate, sine, outside)};
    const Complex n[3] = {outside, film, substrate};
    const Complex turn = std::exp(Complex(0, 4.0 * M_PI * 1e3 * um / nm) * film * c[1]);
    double sum = 0.0;
    for (const bool parallel : {false, true}) {
        const auto r = [&](int i, int j) {
            return parallel ? (n[j] * c[i] - n[i] * c[j]) / (n[j] * c[i] + n[i] * c[j])
                            : (n[i] * c[i] - n[j] * c[j]) / (n[i] * c[i] + n[j] * c[j]);
        };
        sum += 0.5 * std::norm((r(0, 1) + r(1, 2) * turn) / (1.0 + r(0, 1) * r(1, 2) * turn));
    }
    return sum;
}

TEST(ThinFilm, noFilmIsFresnelsReflectance) {
    EXPECT_NEAR(coherentReflectance({}, copperIndex, 550), fresnelAtNormal(copperIndex), 1e-12);
    EXPECT_NEAR(coherentReflectance({{cupriteIndex, 0.0}}, copperIndex, 550), fresnelAtNormal(copperIndex), 1e-12);
    EXPECT_NEAR(coherentReflectance({{copperIndex, 0.05}}, copperIndex, 550), fresnelAtNormal(copperIndex), 1e-12);
    EXPECT_EQ(coherentReflectance({}, copperIndex, 550, 0.0), 1.0);
}

TEST(ThinFilm, aQuarterWaveOfTheRootOfTheIndexReflectsNothing) {
    const double glass = 1.52, n = std::sqrt(glass), nm = 550;
    EXPECT_NEAR(coherentReflectance({{n, nm / (4e3 * n)}}, glass, nm), 0.0, 1e-12);
    EXPECT_NEAR(coherentReflectance({{n, nm / (2e3 * n)}}, glass, nm), fresnelAtNormal(glass), 1e-12);
    // A quarter wave of any index: ((n0 ns - n1²) / (n0 ns + n1²))².
    EXPECT_NEAR(coherentReflectance({{2.0, nm / 8e3}}, glass, nm), std::pow((glass - 4) / (glass + 4), 2), 1e-12);
}

TEST(ThinFilm, oneFilmIsAirysSumAtEveryAngle) {
    Uniforms uniforms("airy");
    for (int i = 0; i < 2000; ++i) {
        const Complex film(uniforms.between(1.0, 3.5), uniforms.between(0.0, 1.0));
        const Complex metal(uniforms.between(0.1, 3.0), uniforms.between(0.0, 5.0));
        const double um = uniforms.between(0.0, 0.4), nm = uniforms.between(380, 780);
        const double cosine = uniforms.between(0.02, 1.0);
        EXPECT_NEAR(coherentReflectance({{film, um}}, metal, nm, cosine), airy(film, um, metal, nm, cosine, 1.0),
                    1e-10);
    }
}

TEST(ThinFilm, twoFilmsOfOneIndexAreOneAndAbsorbersHideWhatIsBelow) {
    EXPECT_NEAR(coherentReflectance({{cupriteIndex, 0.03}, {cupriteIndex, 0.05}}, copperIndex, 500, 0.6),
                coherentReflectance({{cupriteIndex, 0.08}}, copperIndex, 500, 0.6), 1e-12);
    EXPECT_NEAR(coherentReflectance({{cupriteIndex, 1e4}}, copperIndex, 500), fresnelAtNormal(cupriteIndex), 1e-12);
}

TEST(ThinFilm, theTableIsTheFormulaBetweenItsSteps) {
    const Material &copper = shippedMaterials().at("copper"), &cuprite = shippedMaterials().at("cuprite");
    const ThinFilmTable table(copper, cuprite);
    Spectrum read;
    for (float um = 0.0015f; um < 0.15f; um += 0.0037f) {
        table.lookUp(um, read);
        for (int band = 0; band < bandCount; ++band) {
            const CoherentFilm film{{cuprite.indexN[band], cuprite.indexK[band]}, um};
            EXPECT_NEAR(read[band],
                        coherentReflectance({film}, {copper.indexN[band], copper.indexK[band]}, bandWavelengthNm(band)),
                        1e-3);
        }
    }
}

Imath::V3f totalOf(const StackOptics& optics, const std::vector<float>& um) {
    Appearance look;
    optics.evaluate(um.data(), look);
    return test::total(look);
}

class ThinFilmStack : public testing::Test {
  protected:
    const MaterialLibrary& library = shippedMaterials();
    std::vector<const Material*> materials{&library.at("copper"), &library.at("cuprite"), &library.at("brochantite")};
    static StackFeatures thin() {
        StackFeatures features;
        features.thinFilm = true;
        return features;
    }
    StackOptics plain{materials}, interfering{materials, OpticsModel::energyConserving, thin()};
};

// Colours of a smooth film of cuprite (Palik's n, k) on copper (Johnson and Christy) at normal incidence, computed by
// another program every 5 nm from the full tables (CIE 1931 2 degrees, D65). Rows whose colour Rec.709 can show.
TEST_F(ThinFilmStack, coloursAreThoseOfAnotherProgram) {
    const struct {
        float nm;
        Imath::V3d lab;
    } rows[] = {{0, {86.06, 11.85, 13.06}},  {5, {79.98, 16.96, 22.83}},  {10, {69.99, 27.90, 36.04}},
                {15, {55.34, 47.45, 45.38}}, {25, {39.18, 47.81, -2.06}}, {30, {51.42, 16.40, -1.77}},
                {35, {63.13, 4.41, 4.21}},   {40, {71.38, 1.76, 9.16}},   {50, {80.30, 1.67, 15.69}},
                {60, {83.68, 2.20, 21.82}},  {80, {80.73, 10.67, 38.95}}, {100, {61.29, 51.01, 15.56}}};
    for (const auto& row : rows) {
        const Imath::V3d lab = test::labOf(totalOf(interfering, {1e-3f * row.nm, 0.f}));
        EXPECT_LE(deltaE2000(lab, row.lab), 1.0) << row.nm << " nm: " << lab;
    }
}

TEST_F(ThinFilmStack, changesOnlyWhatIsThinnerThan150Nanometres) {
    for (const float um : {0.f, 0.15f, 0.3f, 2.f}) {
        EXPECT_EQ(totalOf(interfering, {um, 0.f}), totalOf(plain, {um, 0.f})) << um;
    }
    EXPECT_GT((totalOf(interfering, {0.05f, 0.f}) - totalOf(plain, {0.05f, 0.f})).length(), 0.05f);
}

TEST_F(ThinFilmStack, coloursRunOnWithoutASeam) {
    // A seam would be a step or a kink: a change of the slope from one nanometre to the next.
    Imath::V3f last = totalOf(interfering, {0.f, 0.f}), slope(0.f);
    for (int nm = 1; nm <= 200; ++nm) {
        const Imath::V3f now = totalOf(interfering, {1e-3f * float(nm), 0.f});
        for (int c = 0; c < 3; ++c) {
            if (nm > 1) {
                EXPECT_NEAR(now[c] - last[c], slope[c], 0.015f) << nm; // 0.01 where a channel meets the gamut's edge
            }
            EXPECT_GE(now[c], 0.f);
            EXPECT_LE(now[c], 1.f);
        }
        slope = now - last;
        last = now;
    }
}

// The minimum of interference moves through the spectrum from the blue as the film grows: a quarter wave of cuprite is
// 37 nm in the blue and 60 in the red, less what the phase at the metal takes. So red comes first, then what lacks
// green, then blue.
TEST_F(ThinFilmStack, theMinimumMovesFromBlueToRed) {
    const auto darkest = [&](int channel) {
        int at = 0;
        float least = 2.f;
        for (int nm = 1; nm <= 100; ++nm) {
            const float value = totalOf(interfering, {1e-3f * float(nm), 0.f})[channel];
            if (value < least) {
                least = value;
                at = nm;
            }
        }
        return at;
    };
    const int green = darkest(1), red = darkest(0);
    EXPECT_GT(green, 15);
    EXPECT_GT(red, green);
    EXPECT_LT(red, 70);
}

} // namespace
} // namespace patina
