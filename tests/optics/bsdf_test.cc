#include "optics/microfacet.h"
#include "optics/patina_bsdf.h"
#include "optics_test_support.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Imath::V3f;
using test::shippedMaterials;
using test::Uniforms;

constexpr double pi = 3.14159265358979323846;

V3f direction(double cosine, double phi) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return {static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
            static_cast<float>(cosine)};
}

V3f threeUniforms(Uniforms& uniforms) {
    const float x = static_cast<float>(uniforms());
    const float y = static_cast<float>(uniforms());
    const float z = static_cast<float>(uniforms());
    return {std::min(x, 0.99999994f), std::min(y, 0.99999994f), std::min(z, 0.99999994f)};
}

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

// Furnace: seen from any direction under a uniformly white sky, no stack may look brighter than the sky.
TEST(PatinaBsdf, tenThousandRandomStacksStayDarkerThanTheFurnace) {
    Uniforms uniforms("furnace");
    float worst = 0.f;
    for (int i = 0; i < 10000; ++i) {
        const PatinaBsdf bsdf(randomAppearance(uniforms));
        const double angle = uniforms.between(0.0, 89.0) * pi / 180.0;
        const Albedo result = albedo(bsdf, direction(std::cos(angle), uniforms() * 2.0 * pi), 128, uniforms);
        for (int c = 0; c < 3; ++c) {
            // Four standard errors, and the lattice tables' own error of 0.003.
            ASSERT_LE(result.mean[c], 1.003 + 4.0 * result.error) << "stack " << i;
            worst = std::max(worst, result.mean[c] - static_cast<float>(4.0 * result.error));
        }
    }
    RecordProperty("brightest", std::to_string(worst));
}

// The worst that can be asked: a perfect mirror, or a perfect white, under every kind of interface.
TEST(PatinaBsdf, perfectlyWhiteStacksStayDarkerThanTheFurnace) {
    Uniforms uniforms("white furnace");
    Material mirror;
    mirror.isMetal = true;
    mirror.reflectance = Spectrum::constant(1.f);
    for (int i = 0; i < 200; ++i) {
        Material film;
        film.scattering = Spectrum::constant(static_cast<float>(uniforms.logBetween(1e-3, 10.0)));
        film.refractiveIndex = static_cast<float>(uniforms.between(1.0, 3.0));
        film.roughness = static_cast<float>(uniforms.logBetween(1e-3, 1.0));
        Material second = film;
        second.refractiveIndex = static_cast<float>(uniforms.between(1.0, 3.0));
        second.roughness = static_cast<float>(uniforms.logBetween(1e-3, 1.0));
        mirror.roughness = static_cast<float>(uniforms.logBetween(1e-3, 1.0));
        const float thicknessUm[] = {static_cast<float>(uniforms.logBetween(0.01, 10.0)),
                                     static_cast<float>(uniforms.logBetween(0.01, 10.0))};
        Appearance out;
        StackOptics({&mirror, &film, &second}).evaluate(thicknessUm, out);
        const PatinaBsdf bsdf(out);
        for (double degrees : {0.0, 45.0, 75.0, 85.0, 89.0}) {
            const Albedo result = albedo(bsdf, direction(std::cos(degrees * pi / 180.0), 0.3), 1000, uniforms);
            for (int c = 0; c < 3; ++c) {
                ASSERT_LE(result.mean[c], 1.003 + 4.0 * result.error) << "stack " << i << " at " << degrees;
            }
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

/// Integral of the density over a patch of directions, by the midpoint rule.
double patchProbability(const PatinaBsdf& bsdf, const V3f& wo, double c0, double c1, double p0, double p1) {
    constexpr int fine = 24;
    double sum = 0.0;
    for (int i = 0; i < fine; ++i) {
        for (int j = 0; j < fine; ++j) {
            sum += bsdf.pdf(wo, direction(c0 + (c1 - c0) * (i + 0.5) / fine, p0 + (p1 - p0) * (j + 0.5) / fine));
        }
    }
    return sum * (c1 - c0) * (p1 - p0) / (fine * fine);
}

// Pearson's chi² of drawn directions against the density, as pbrt and Mitsuba test theirs: 100,000 samples in 10 × 20
// patches, patches expecting fewer than 5 pooled, with what falls below the horizon as one more.
TEST(PatinaBsdf, samplesFollowTheirDensity) {
    const Appearance cases[] = {look({"copper"}, {}),
                                look({"copper", "tarnish_1"}, {0.08f}),
                                look({"copper", "cuprite_2", "marine_patina_4"}, {0.15f, 0.2f}),
                                look({"copper", "cuprite_2", "marine_patina_4"}, {1.f, 5.f}),
                                look({"copper", "cuprite_2", "rural_patina_4", "wax"}, {0.3f, 0.5f, 3.f}),
                                look({"copper", "tarnish_1", "patina_urban_4"}, {0.05f, 0.5f}, OpticsModel::paper)};
    Uniforms uniforms("chi square");
    int number = 0;
    for (const Appearance& appearance : cases) {
        const PatinaBsdf bsdf(appearance);
        for (double degrees : {10.0, 60.0, 80.0}) {
            const V3f wo = direction(std::cos(degrees * pi / 180.0), 0.7);
            constexpr int rows = 10, columns = 20, samples = 100000;
            std::vector<int> counts(rows * columns, 0);
            int lost = 0;
            for (int i = 0; i < samples; ++i) {
                const BsdfSample drawn = bsdf.sample(wo, threeUniforms(uniforms));
                if (drawn.pdf <= 0.f) {
                    ++lost;
                    continue;
                }
                double phi = std::atan2(drawn.wi.y, drawn.wi.x);
                phi = phi < 0.0 ? phi + 2.0 * pi : phi;
                const int row = std::min(static_cast<int>(drawn.wi.z * rows), rows - 1);
                const int column = std::min(static_cast<int>(phi / (2.0 * pi) * columns), columns - 1);
                ++counts[row * columns + column];
            }
            double chi2 = 0.0, pooledExpected = 0.0, pooledCount = lost, sum = 0.0;
            int freedom = 0;
            for (int row = 0; row < rows; ++row) {
                for (int column = 0; column < columns; ++column) {
                    const double expected = samples * patchProbability(bsdf, wo, row / 10.0, (row + 1) / 10.0,
                                                                       column * pi / 10.0, (column + 1) * pi / 10.0);
                    const int count = counts[row * columns + column];
                    sum += expected;
                    if (expected < 5.0) {
                        pooledExpected += expected;
                        pooledCount += count;
                        continue;
                    }
                    chi2 += (count - expected) * (count - expected) / expected;
                    ++freedom;
                }
            }
            pooledExpected += samples - sum; // the density of what is lost below the horizon
            if (pooledExpected > 5.0) {
                chi2 += (pooledCount - pooledExpected) * (pooledCount - pooledExpected) / pooledExpected;
            } else {
                EXPECT_LT(pooledCount, pooledExpected + 15.0);
            }
            // 18 cases at a significance of 0.01 together: about 3.5 standard deviations of chi².
            EXPECT_LT((chi2 - freedom) / std::sqrt(2.0 * freedom), 3.5) << "case " << number << " at " << degrees;
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
