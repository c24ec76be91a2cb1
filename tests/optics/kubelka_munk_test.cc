#include "optics/kubelka_munk.h"
#include "optics_test_support.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace patina {
namespace {

using test::Uniforms;

TEST(KubelkaMunk, givesThePublishedValues) {
    const auto layer = kubelkaMunkLayer(1.0, 2.0, 0.5);
    EXPECT_NEAR(layer.reflectance, 0.346546065857, 1e-12);
    EXPECT_NEAR(layer.transmittance, 0.283647630326, 1e-12);
    const auto single = kubelkaMunkLayer(1.f, 2.f, 0.5f);
    EXPECT_NEAR(single.reflectance, 0.346546065857f, 1e-6f);
    EXPECT_NEAR(infiniteReflectance(0.5, 1.0), 0.381966011250, 1e-12);
    EXPECT_NEAR(infiniteReflectance(0.1, 1.0), 0.641742430504, 1e-12);
    EXPECT_NEAR(infiniteReflectance(1.0, 1.0), 0.267949192431, 1e-12);
    EXPECT_NEAR(infiniteReflectance(4.0, 1.0), 0.101020514434, 1e-12);
    EXPECT_NEAR(absorptionOverScattering(0.1), 4.05, 1e-12);
    EXPECT_NEAR(absorptionOverScattering(0.5), 0.25, 1e-12);
    EXPECT_NEAR(absorptionOverScattering(0.9), 0.0055555555556, 1e-12);
}

// Values of another program's tests (lindemeier/painty, kubelka_munk_test.cpp), printed to six digits.
template <typename Real>
void checkAnotherProgram(Real tolerance) {
    EXPECT_NEAR(overBackground(kubelkaMunkLayer<Real>(0.2, 0.124, 0.5), Real(0.65)), 0.541596, tolerance);
    EXPECT_NEAR(overBackground(kubelkaMunkLayer<Real>(0.1, 0.658, 0.5), Real(0.2)), 0.343822, tolerance);
    EXPECT_NEAR(overBackground(kubelkaMunkLayer<Real>(0.22, 0.123, 0.5), Real(0.2146)), 0.206651, tolerance);
    EXPECT_NEAR(overBackground(kubelkaMunkLayer<Real>(0.2, 0.0, 0.5), Real(0.65)), 0.53217499728, tolerance);
}

TEST(KubelkaMunk, agreesWithAnotherProgramOverABackground) {
    checkAnotherProgram<double>(1e-6);
    checkAnotherProgram<float>(1e-4f);
    EXPECT_NEAR(overBackground(kubelkaMunkLayer(0.2, 0.0, 0.5), 0.65), 0.65 * std::exp(-2.0 * 0.2 * 0.5), 1e-14);
}

template <typename Real>
void checkLimits(Real tolerance) {
    const Real infinity = std::numeric_limits<Real>::infinity();
    auto layer = kubelkaMunkLayer<Real>(0, 2, 3); // no absorption: R = S d / (1 + S d)
    EXPECT_NEAR(layer.reflectance, 6.0 / 7.0, tolerance);
    EXPECT_NEAR(layer.transmittance, 1.0 / 7.0, tolerance);
    layer = kubelkaMunkLayer<Real>(2, 0, Real(0.5)); // no scattering: Beer's law
    EXPECT_EQ(layer.reflectance, 0);
    EXPECT_NEAR(layer.transmittance, std::exp(-1.0), tolerance);
    layer = kubelkaMunkLayer<Real>(1, 1, 0);
    EXPECT_EQ(layer.reflectance, 0);
    EXPECT_EQ(layer.transmittance, 1);
    layer = kubelkaMunkLayer<Real>(0, 0, 5);
    EXPECT_EQ(layer.reflectance, 0);
    EXPECT_EQ(layer.transmittance, 1);
    layer = kubelkaMunkLayer<Real>(1, 1, infinity);
    EXPECT_NEAR(layer.reflectance, 0.267949192431, tolerance);
    EXPECT_EQ(layer.transmittance, 0);
    layer = kubelkaMunkLayer<Real>(0, 1, infinity);
    EXPECT_EQ(layer.reflectance, 1);
    layer = kubelkaMunkLayer<Real>(1, 1, Real(1e6)); // sinh of this overflows
    EXPECT_NEAR(layer.reflectance, 0.267949192431, tolerance);
    EXPECT_EQ(layer.transmittance, 0);
    layer = kubelkaMunkLayer<Real>(Real(0.3), Real(0.7), Real(1e-4)); // R ~ S d, T ~ 1 - (K + S) d
    EXPECT_NEAR(layer.reflectance, 7e-5, 1e-8);
    EXPECT_NEAR(layer.transmittance, 1.0 - 1e-4, 1e-7);
}

TEST(KubelkaMunk, holdsAtEveryLimitInBothPrecisions) {
    checkLimits<double>(1e-12);
    checkLimits<float>(1e-6f);
}

// White without end over white: every photon comes back, and the printed form is 0 / 0.
template <typename Real>
void checkWhiteOverWhite() {
    const Real infinity = std::numeric_limits<Real>::infinity();
    for (const Real d : {Real(1), Real(1e9), Real(1e30), infinity}) {
        for (const Real scattering : {Real(1e-6), Real(1), Real(1e6)}) {
            const auto layer = kubelkaMunkLayer<Real>(0, scattering, d);
            EXPECT_NEAR(overBackground(layer, Real(1)), 1.0, 1e-6) << scattering << " " << d;
            const auto both = onTop(StackLight<Real>(layer), StackLight<Real>(layer));
            EXPECT_NEAR(both.reflectanceAbove + both.transmittance, 1.0, 1e-6) << scattering << " " << d;
            EXPECT_EQ(both.reflectanceAbove, both.reflectanceBelow);
        }
    }
}

TEST(KubelkaMunk, whiteWithoutEndOverWhiteIsWhite) {
    checkWhiteOverWhite<double>();
    checkWhiteOverWhite<float>();
}

TEST(KubelkaMunk, neverGivesNaNAndNeverGainsInAMillionSinglePrecisionStacks) {
    Uniforms uniforms("million");
    const auto pick = [&](double low, double high) {
        const double u = uniforms();
        return static_cast<float>(u < 0.05 ? 0.0 : low * std::pow(high / low, (u - 0.05) / 0.95));
    };
    for (int i = 0; i < 1000000; ++i) {
        const double u = uniforms();
        const float base = u < 0.1 ? 0.f : u > 0.9 ? 1.f : static_cast<float>(u);
        float folded = base;
        StackLight<float> merged;
        for (int k = 0; k < 3; ++k) {
            const float absorption = pick(1e-6, 1e3), scattering = pick(1e-6, 1e3);
            const float d = uniforms() < 0.05 ? std::numeric_limits<float>::infinity() : pick(1e-6, 1e4);
            const auto layer = kubelkaMunkLayer(absorption, scattering, d);
            ASSERT_GE(layer.reflectance, 0.f);
            ASSERT_GE(layer.transmittance, 0.f);
            ASSERT_LE(layer.reflectance + layer.transmittance, 1.f + 1e-5f);
            folded = overBackground(layer, folded);
            ASSERT_TRUE(folded >= 0.f && folded <= 1.f + 1e-5f) << folded;
            merged = onTop(StackLight<float>(layer), merged);
            for (const float part : {merged.reflectanceAbove, merged.reflectanceBelow, merged.transmittance}) {
                ASSERT_TRUE(part >= 0.f && part <= 1.f + 1e-5f) << part;
            }
            ASSERT_LE(merged.reflectanceAbove + merged.transmittance, 1.f + 2e-5f);
        }
        const float over =
            merged.reflectanceAbove +
            merged.transmittance * base * interreflected(merged.transmittance, merged.reflectanceBelow, base);
        ASSERT_NEAR(over, folded, 1e-4f);
    }
}

TEST(KubelkaMunk, singlePrecisionIsWithinATenThousandthOfDouble) {
    Uniforms uniforms("precision");
    for (int i = 0; i < 100000; ++i) {
        const double k = uniforms.logBetween(1e-4, 1e2);
        const double s = uniforms.logBetween(1e-4, 1e2);
        const double d = uniforms.logBetween(1e-4, 1e2);
        const auto exact = kubelkaMunkLayer(k, s, d);
        const auto single = kubelkaMunkLayer(static_cast<float>(k), static_cast<float>(s), static_cast<float>(d));
        ASSERT_NEAR(exact.reflectance, single.reflectance, 1e-4);
        ASSERT_NEAR(exact.transmittance, single.transmittance, 1e-4);
    }
}

// 1e-6 in double. In single precision the reflectances themselves are rounded at 6e-8, and a layer that hides its
// backing tells little of its thickness: 1e-4 holds where half a percent or more of the backing's light shows.
TEST(KubelkaMunk, invertsTwoBackings) {
    Uniforms uniforms("backings");
    for (int i = 0; i < 2000; ++i) {
        const double k = uniforms.logBetween(0.01, 3.0);
        const double s = uniforms.logBetween(0.05, 3.0);
        const double backing = uniforms.between(0.3, 1.0);
        const auto layer = kubelkaMunkLayer(k, s, 0.8);
        const double over = overBackground(layer, backing);
        const auto found = fromTwoBackings(layer.reflectance, over, backing);
        EXPECT_NEAR(found.absorption, k * 0.8, 1e-6 * (1.0 + k));
        EXPECT_NEAR(found.scattering, s * 0.8, 1e-6 * (1.0 + s));
        if (over - layer.reflectance > 0.005) {
            const auto single = fromTwoBackings(static_cast<float>(layer.reflectance), static_cast<float>(over),
                                                static_cast<float>(backing));
            EXPECT_NEAR(single.absorption, k * 0.8, 1e-4 * (1.0 + k)) << k << " " << s << " " << backing;
            EXPECT_NEAR(single.scattering, s * 0.8, 1e-4 * (1.0 + s)) << k << " " << s << " " << backing;
        }
    }
}

TEST(KubelkaMunk, invertsAnOpaqueAndAThinSample) {
    const auto layer = kubelkaMunkLayer(0.3, 0.9, 1.7);
    const auto found = fromOpaqueAndThin(infiniteReflectance(0.3, 0.9), layer.reflectance);
    EXPECT_NEAR(found.absorption, 0.3 * 1.7, 1e-10);
    EXPECT_NEAR(found.scattering, 0.9 * 1.7, 1e-10);
    const auto single =
        fromOpaqueAndThin(static_cast<float>(infiniteReflectance(0.3, 0.9)), static_cast<float>(layer.reflectance));
    EXPECT_NEAR(single.absorption, 0.3 * 1.7, 1e-4);
    EXPECT_NEAR(single.scattering, 0.9 * 1.7, 1e-4);
}

struct RandomLayer {
    double k, s, d;
};

RandomLayer randomLayer(Uniforms& uniforms) {
    return {uniforms.logBetween(0.01, 10.0), uniforms.logBetween(0.01, 10.0), uniforms.logBetween(0.01, 1.0)};
}

StackLight<double> lightOf(const RandomLayer& layer) {
    return kubelkaMunkLayer(layer.k, layer.s, layer.d);
}

TEST(KubelkaMunk, splittingALayerChangesNothing) {
    Uniforms uniforms("split");
    for (int i = 0; i < 10000; ++i) {
        const RandomLayer layer = randomLayer(uniforms);
        const double part = uniforms() * layer.d;
        const auto whole = lightOf(layer);
        const auto halves = onTop(lightOf({layer.k, layer.s, part}), lightOf({layer.k, layer.s, layer.d - part}));
        ASSERT_NEAR(whole.reflectanceAbove, halves.reflectanceAbove, 1e-12);
        ASSERT_NEAR(whole.reflectanceBelow, halves.reflectanceBelow, 1e-12);
        ASSERT_NEAR(whole.transmittance, halves.transmittance, 1e-12);
    }
}

TEST(KubelkaMunk, stackingIsAssociativeAndEqualsTheFoldFromTheBaseUp) {
    Uniforms uniforms("associative");
    for (int i = 0; i < 10000; ++i) {
        const RandomLayer a = randomLayer(uniforms), b = randomLayer(uniforms), c = randomLayer(uniforms);
        const auto left = onTop(onTop(lightOf(a), lightOf(b)), lightOf(c));
        const auto right = onTop(lightOf(a), onTop(lightOf(b), lightOf(c)));
        ASSERT_NEAR(left.reflectanceAbove, right.reflectanceAbove, 1e-12);
        ASSERT_NEAR(left.reflectanceBelow, right.reflectanceBelow, 1e-12);
        ASSERT_NEAR(left.transmittance, right.transmittance, 1e-12);
        const double base = uniforms();
        double folded = base;
        for (const RandomLayer& layer : {c, b, a}) {
            folded = overBackground(kubelkaMunkLayer(layer.k, layer.s, layer.d), folded);
        }
        const double merged = left.reflectanceAbove +
                              left.transmittance * left.transmittance * base / (1.0 - left.reflectanceBelow * base);
        ASSERT_NEAR(folded, merged, 1e-12);
    }
}

// A strong scatterer over an absorber: 0.58124746920. Composing front to back with one reflectance for both sides, as
// the paper's text reads, gives 0.58204596752.
TEST(KubelkaMunk, keepsFrontAndBackReflectanceApart) {
    const double d[3] = {1.0, 0.4, 0.7};
    const auto a = kubelkaMunkLayer(0.2, 2.0, d[0]);
    const auto b = kubelkaMunkLayer(3.0, 0.2, d[1]);
    const auto c = kubelkaMunkLayer(0.5, 1.0, d[2]);
    const double exact = overBackground(a, overBackground(b, overBackground(c, 0.6)));
    const auto merged = onTop(onTop(StackLight<double>(a), StackLight<double>(b)), StackLight<double>(c));
    const double other = merged.reflectanceAbove +
                         merged.transmittance * merged.transmittance * 0.6 / (1.0 - merged.reflectanceBelow * 0.6);
    EXPECT_NEAR(exact, 0.58124746920, 5e-12);
    EXPECT_NEAR(exact, other, 1e-14);
    const auto naive = [](const LayerLight<double>& top, const LayerLight<double>& bottom) {
        const double divisor = 1.0 - top.reflectance * bottom.reflectance;
        return LayerLight<double>{top.reflectance +
                                      top.transmittance * top.transmittance * bottom.reflectance / divisor,
                                  top.transmittance * bottom.transmittance / divisor};
    };
    EXPECT_NEAR(overBackground(naive(naive(a, b), c), 0.6), 0.58204596752, 5e-12);
}

using Real = long double;
using Matrix2 = std::array<Real, 4>;

Matrix2 multiply(const Matrix2& a, const Matrix2& b) {
    return {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]};
}

/// exp(m), by halving until the Taylor series converges and squaring back.
Matrix2 exponential(Matrix2 m) {
    constexpr int halvings = 12;
    for (Real& v : m) {
        v = std::ldexp(v, -halvings);
    }
    Matrix2 result = {1, 0, 0, 1};
    Matrix2 term = result;
    for (int n = 1; n < 16; ++n) {
        term = multiply(term, m);
        for (int i = 0; i < 4; ++i) {
            term[i] /= n;
            result[i] += term[i];
        }
    }
    for (int i = 0; i < halvings; ++i) {
        result = multiply(result, result);
    }
    return result;
}

// The two flux equations (with the second sign put right) as dB/dz = M B, B = (B+, B-): B(d) = exp(M d) B(0) = P B(0).
// Light from above over black, B-(d) = 0: R = -P21 / P22, and T = 1 / P22 because det P = exp(trace) = 1; light from
// below, B+(0) = 0: R' = P12 / P22; over a base g, B-(d) = g B+(d): R = (g P11 - P21) / (P22 - g P12). None of these
// subtracts what nearly cancels, however thick the layers are.
TEST(KubelkaMunk, solvesTheDifferentialEquations) {
    Uniforms uniforms("matrix");
    double thickest = 0.0;
    for (int i = 0; i < 2000; ++i) {
        Matrix2 through = {1, 0, 0, 1};
        StackLight<double> stack;
        const int count = 1 + uniforms.below(4);
        std::vector<RandomLayer> layers;
        double depth = 0.0;
        for (int n = 0; n < count; ++n) { // from the top down
            layers.push_back(randomLayer(uniforms));
            layers[n].d *= 3.0;
            const Real k = layers[n].k, scatter = layers[n].s, d = layers[n].d;
            through =
                multiply(exponential({-(k + scatter) * d, scatter * d, -scatter * d, (k + scatter) * d}), through);
            depth += (layers[n].k + layers[n].s) * layers[n].d;
            stack = n == 0 ? lightOf(layers[0]) : onTop(stack, lightOf(layers[n]));
        }
        thickest = std::max(thickest, depth);
        ASSERT_NEAR(stack.reflectanceAbove, double(-through[2] / through[3]), 1e-12);
        ASSERT_NEAR(stack.reflectanceBelow, double(through[1] / through[3]), 1e-12);
        ASSERT_NEAR(stack.transmittance, double(1 / through[3]), 1e-12);
        const double base = uniforms();
        double folded = base; // each layer once, from the base up
        for (int n = count - 1; n >= 0; --n) {
            folded = overBackground(kubelkaMunkLayer(layers[n].k, layers[n].s, layers[n].d), folded);
        }
        ASSERT_NEAR(folded, double((base * through[0] - through[2]) / (through[3] - base * through[1])), 1e-12);
    }
    EXPECT_GT(thickest, 25.0);
}

} // namespace
} // namespace patina
