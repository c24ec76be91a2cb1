#include "chi_square.h"
#include "optics/microfacet.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Imath::V3f;
using test::direction;
using test::shippedMaterials;
using test::threeUniforms;
using test::Uniforms;

constexpr double pi = 3.14159265358979323846;

Appearance randomAppearance(Uniforms& uniforms, OpticsModel model = OpticsModel::energyConserving) {
    const test::RandomStack stack = test::randomStack(uniforms);
    Appearance out;
    StackOptics(stack.materials, model).evaluate(stack.thicknessUm.data(), out);
    return out;
}

Appearance look(const std::vector<std::string>& names, const std::vector<float>& thicknessUm,
                OpticsModel model = OpticsModel::energyConserving) {
    std::vector<const Material*> materials;
    for (const std::string& name : names) {
        materials.push_back(&shippedMaterials().at(name));
    }
    Appearance out;
    StackOptics(materials, model).evaluate(thicknessUm.data(), out);
    return out;
}

/// Mean weight of n samples, and the standard error of its brightest channel.
struct Albedo {
    V3f mean{0.f};
    double error = 0.0;
};

Albedo albedo(const PatinaBsdf& bsdf, const V3f& wo, int samples, Uniforms& uniforms) {
    Imath::V3d sum(0.0), squares(0.0);
    for (int i = 0; i < samples; ++i) {
        const Imath::V3d weight(bsdf.sample(wo, threeUniforms(uniforms)).weight);
        sum += weight;
        squares += weight * weight;
    }
    const Imath::V3d mean = sum / samples;
    Albedo result;
    result.mean = V3f(mean);
    for (int c = 0; c < 3; ++c) {
        result.error =
            std::max(result.error, std::sqrt(std::max(squares[c] / samples - mean[c] * mean[c], 0.0) / samples));
    }
    return result;
}

// Furnace: seen from any direction under a uniformly white sky, no stack may look brighter than the sky. A thousand
// stacks; bsdf_slow_test.cc has ten thousand, more angles and more light.
TEST(PatinaBsdf, aThousandRandomStacksStayDarkerThanTheFurnace) {
    Uniforms uniforms("furnace");
    for (int i = 0; i < 1000; ++i) {
        const PatinaBsdf bsdf(randomAppearance(uniforms));
        const double angle = uniforms.between(0.0, 89.0) * pi / 180.0;
        const Albedo result = albedo(bsdf, direction(std::cos(angle), uniforms() * 2.0 * pi), 256, uniforms);
        for (int c = 0; c < 3; ++c) {
            ASSERT_LE(result.mean[c], 1.0 + 4.0 * result.error + 1e-5) << "stack " << i;
        }
    }
}

TEST(PatinaBsdf, paperModelGainsEnergy) {
    Uniforms uniforms("paper furnace");
    const PatinaBsdf bsdf(look({"copper"}, {}, OpticsModel::paper));
    EXPECT_GT(albedo(bsdf, direction(1.0, 0.0), 20000, uniforms).mean.x, 1.2f);
}

// ∫ (N·H)^n cos at normal incidence = 8 pi (2^(-n/2) + n) / ((n + 2)(n + 4)).
TEST(PatinaBsdf, paperLobeHasItsClosedFormAlbedo) {
    Uniforms uniforms("paper lobe");
    Appearance out;
    out.model = OpticsModel::paper;
    out.lobes.resize(1);
    out.lobes[0].colour = out.lobes[0].edgeColour = V3f(1.f);
    for (double n : {10.0, 50.0, 100.0}) {
        out.lobes[0].roughness = static_cast<float>(1.0 / n);
        const double exact = 8.0 * pi * (std::pow(2.0, -n / 2.0) + n) / ((n + 2.0) * (n + 4.0));
        const Albedo result = albedo(PatinaBsdf(out), direction(1.0, 0.0), 50000, uniforms);
        EXPECT_NEAR(result.mean.x, exact, 5.0 * result.error + 1e-4 * exact);
    }
}

TEST(PatinaBsdf, isReciprocal) {
    Uniforms uniforms("reciprocity");
    for (int i = 0; i < 20000; ++i) {
        const OpticsModel model = i % 4 == 0 ? OpticsModel::paper : OpticsModel::energyConserving;
        const PatinaBsdf bsdf(randomAppearance(uniforms, model));
        const V3f a = direction(uniforms(), uniforms() * 2.0 * pi);
        const V3f b = direction(uniforms(), uniforms() * 2.0 * pi);
        const V3f there = bsdf.evaluate(a, b);
        const V3f back = bsdf.evaluate(b, a);
        for (int c = 0; c < 3; ++c) {
            ASSERT_GE(there[c], 0.f);
            ASSERT_NEAR(there[c], back[c], 1e-6 * std::max(1.f, there[c]));
        }
    }
}

TEST(PatinaBsdf, nothingComesFromBelow) {
    const PatinaBsdf bsdf(look({"copper"}, {}));
    EXPECT_EQ(bsdf.evaluate({0, 0, 1}, {0, 0, -1}), V3f(0.f));
    EXPECT_EQ(bsdf.evaluate({0, 0, -1}, {0, 0, 1}), V3f(0.f));
    EXPECT_EQ(bsdf.pdf({0, 0, 1}, {0, 0, -1}), 0.f);
    EXPECT_EQ(bsdf.sample({0, 0, -1}, {0.5f, 0.5f, 0.5f}).pdf, 0.f);
}

// TRUTHS: 0.31607 for n = 1.5 over a Lambertian base of 0.5, light from the normal, within 1 %.
TEST(PatinaBsdf, smoothDielectricOverALambertianBase) {
    Material base;
    base.isMetal = true;
    Material film;
    film.scattering = Spectrum::constant(1.f);
    film.absorption = Spectrum::constant(0.25f);
    film.refractiveIndex = 1.5f;
    film.roughness = 1e-4f;
    Appearance out;
    const float opaque[] = {1e4f};
    StackOptics({&base, &film}).evaluate(opaque, out);
    Uniforms uniforms("lambertian");
    const Albedo result = albedo(PatinaBsdf(out), {0, 0, 1}, 40000, uniforms);
    EXPECT_NEAR(result.mean.y, 0.31607, 0.0031607);
    // Under a uniform sky, averaged over all directions: 0.35296.
    double sum = 0.0;
    for (int i = 0; i < 64; ++i) {
        const double cosine = std::sqrt((i + 0.5) / 64);
        sum += albedo(PatinaBsdf(out), direction(cosine, 0.0), 2000, uniforms).mean.y / 64;
    }
    EXPECT_NEAR(sum, 0.35296, 0.01);
}

TEST(PatinaBsdf, theTailOfChiSquareIsTheTabulatedOne) { // 95 % points of any table
    EXPECT_NEAR(test::chiSquareTail(3.841459, 1), 0.05, 1e-7);
    EXPECT_NEAR(test::chiSquareTail(18.307038, 10), 0.05, 1e-7);
    EXPECT_NEAR(test::chiSquareTail(124.342113, 100), 0.05, 1e-7);
    EXPECT_NEAR(test::chiSquareTail(2.0, 2), std::exp(-1.0), 1e-14);
    EXPECT_NEAR(test::chiSquareTail(60.0, 2), std::exp(-30.0), 1e-20);
}

// 100,000 samples; bsdf_slow_test.cc draws a million, of more looks. Significance 0.01 over all together.
TEST(PatinaBsdf, samplesFollowTheirDensity) {
    const Appearance cases[] = {look({"copper"}, {}), look({"copper", "cuprite_2", "marine_patina_4"}, {0.15f, 0.2f}),
                                look({"copper", "cuprite_2", "lacquer"}, {0.3f, 20.f}),
                                look({"copper", "tarnish_1", "patina_urban_4"}, {0.05f, 0.5f}, OpticsModel::paper)};
    const double significance = 1.0 - std::pow(0.99, 1.0 / 8.0);
    Uniforms uniforms("chi square");
    int number = 0;
    for (const Appearance& appearance : cases) {
        for (const double degrees : {15.0, 75.0}) {
            const V3f wo = direction(std::cos(degrees * pi / 180.0), 0.7);
            EXPECT_GT(test::samplingPValue(PatinaBsdf(appearance), wo, 100000, 16, uniforms), significance)
                << "case " << number << " at " << degrees;
        }
        ++number;
    }
}

TEST(PatinaBsdf, weightIsValueTimesCosineOverDensity) {
    Uniforms uniforms("weight");
    for (int i = 0; i < 2000; ++i) {
        const PatinaBsdf bsdf(randomAppearance(uniforms));
        const V3f wo = direction(uniforms.between(0.05, 1.0), 1.0);
        const BsdfSample drawn = bsdf.sample(wo, threeUniforms(uniforms));
        if (drawn.pdf <= 0.f) {
            EXPECT_EQ(drawn.weight, V3f(0.f));
            continue;
        }
        EXPECT_NEAR(drawn.wi.length(), 1.f, 1e-4f);
        const V3f expected = bsdf.evaluate(wo, drawn.wi) * (drawn.wi.z / bsdf.pdf(wo, drawn.wi));
        EXPECT_NEAR(drawn.weight.y, expected.y, 1e-4f * std::max(1.f, expected.y));
    }
}

TEST(Microfacet, alphaMatchesThePapersLobeAtItsTop) {
    for (float roughness : {0.01f, 0.1f, 0.5f}) {
        const double n = 1.0 / roughness;
        EXPECT_NEAR(ggxDistribution({0, 0, 1}, ggxAlpha(roughness)), (n + 2.0) / (2.0 * pi), 1e-3 * n);
    }
}

// The air's lobe is taken from what it lets through: the table must not say less than the integral, or light would be
// made. Stratified visible normals; 0.001 is what their sum may be off.
TEST(Microfacet, theTableNeverSaysLessThanTheIntegral) {
    Uniforms uniforms("conservative albedo");
    for (int i = 0; i < 400; ++i) {
        const float alpha = static_cast<float>(std::max(std::pow(uniforms(), 2), 0.005));
        const float cosine = static_cast<float>(std::max(std::pow(uniforms(), 2), 0.0175));
        const V3f wo = direction(cosine, 0.0);
        double flat = 0.0, rising = 0.0;
        constexpr int grid = 96;
        for (int a = 0; a < grid; ++a) {
            const double rest = 1.0 - (a + 0.5) / grid; // more points in the long tail
            for (int b = 0; b < grid; ++b) {
                const V3f h = sampleVisibleNormal(wo, alpha, static_cast<float>(1.0 - rest * rest),
                                                  static_cast<float>((b + 0.5) / grid));
                const V3f wi = 2.f * wo.dot(h) * h - wo;
                if (wi.z > 0.f && wo.dot(h) > 0.f) {
                    const double weight =
                        2.0 * rest * smithVisibility(wo, wi, alpha) * 4.0 * wo.z * wi.z / smithMasking(wo, alpha);
                    const double s = schlickWeight(wo.dot(h));
                    flat += weight * (1.0 - s);
                    rising += weight * s;
                }
            }
        }
        const LobeAlbedo table = lobeAlbedo(cosine, alpha);
        EXPECT_GE(table.flat, flat / (grid * grid) - 0.001) << alpha << " " << cosine;
        EXPECT_GE(table.rising, rising / (grid * grid) - 0.001) << alpha << " " << cosine;
        EXPECT_LE(table.flat + table.rising, (flat + rising) / (grid * grid) + 0.015) << alpha << " " << cosine;
    }
}

TEST(Microfacet, tabulatedAlbedoIsTheIntegral) {
    Uniforms uniforms("albedo");
    for (int i = 0; i < 60; ++i) {
        const float alpha = static_cast<float>(uniforms.between(0.02, 1.0));
        const float cosine = static_cast<float>(uniforms.between(0.02, 1.0));
        const V3f wo = direction(cosine, 0.0);
        double sum = 0.0;
        constexpr int samples = 40000;
        for (int s = 0; s < samples; ++s) {
            const V3f u = threeUniforms(uniforms);
            const V3f h = sampleVisibleNormal(wo, alpha, u.x, u.y);
            const V3f wi = 2.f * wo.dot(h) * h - wo;
            if (wi.z > 0.f && wo.dot(h) > 0.f) {
                sum += smithVisibility(wo, wi, alpha) * 4.0 * wo.z * wi.z / smithMasking(wo, alpha);
            }
        }
        const LobeAlbedo table = lobeAlbedo(cosine, alpha);
        EXPECT_NEAR(table.flat + table.rising, sum / samples, 0.006) << alpha << " " << cosine;
    }
}

} // namespace
} // namespace patina
