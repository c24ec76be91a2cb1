#include "render/lights.h"

#include "base/errors.h"
#include "render/pixel_sampler.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3f;

constexpr double pi = M_PI;

/// Directions evenly over the sphere (a Fibonacci spiral).
V3f spiral(int i, int count) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, phi = i * pi * (3.0 - std::sqrt(5.0)), r = std::sqrt(1.0 - z * z);
    return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
}

TEST(Lights, densitiesIntegrateToOne) {
    const Lights lights = studioLights(UpAxis::y, 30.f);
    constexpr int count = 400000;
    for (const V3f& normal : {V3f(0, 1, 0), V3f(0.6f, 0, 0.8f), V3f(0, -1, 0)})
        for (const auto source : {Lights::environment, Lights::keyLight}) {
            double sum = 0.0;
            for (int i = 0; i < count; ++i)
                sum += double(lights.pdf(source, normal, spiral(i, count)));
            // The key light's disc covers 0.2 % of the sphere: 760 points, its rim some 30 of them.
            EXPECT_NEAR(sum * 4.0 * pi / count, 1.0, source == Lights::keyLight ? 0.04 : 0.005);
        }
}

TEST(Lights, aSampleReportsItsOwnDensityAndRadiance) {
    const Lights lights = studioLights(UpAxis::z, 70.f);
    const KeyedRandom random(1, "lights", "test");
    PixelSampler sampler(random, 0, 0);
    const V3f normal = V3f(0.3f, -0.5f, 0.6f).normalized();
    for (std::uint32_t i = 0; i < 2000; ++i)
        for (const auto source : {Lights::environment, Lights::keyLight}) {
            sampler.startSample(i);
            const Lights::Sample s = lights.sample(source, normal, sampler.next2());
            EXPECT_NEAR(s.direction.length(), 1.f, 1e-5f);
            EXPECT_GT(s.pdf, 0.f);
            EXPECT_GE(s.direction.z, -1e-3f); // this set sends no shadow rays into its floor
            // On the border of a cell rounding may name its neighbour: compare only clearly inside.
            const float density = lights.pdf(source, normal, s.direction);
            const float aside = lights.pdf(source, normal, (s.direction + V3f(1e-4f, -1e-4f, 1e-4f)).normalized());
            if (density == aside) {
                EXPECT_NEAR(s.pdf / density, 1.f, 1e-4f);
            }
            if (density > 0.f) {
                EXPECT_NEAR((s.radiance - lights.radiance(source, s.direction)).length(), 0.f, 1e-5f);
            }
        }
}

TEST(Lights, samplingFindsTheIrradianceOfQuadrature) {
    const Lights lights = studioLights(UpAxis::z);
    const KeyedRandom random(1, "lights", "test");
    constexpr std::uint32_t count = 1 << 15;
    // A floor, and a wall seen by half the set; both face the key light's whole disc.
    for (const V3f& normal : {V3f(0, 0, 1), V3f(-0.5f, -0.7f, 0.4f).normalized()}) {
        PixelSampler sampler(random, 1, 2);
        double sum = 0.0;
        for (std::uint32_t i = 0; i < count; ++i) {
            sampler.startSample(i);
            for (const auto source : {Lights::environment, Lights::keyLight}) {
                const Lights::Sample s = lights.sample(source, normal, sampler.next2());
                sum += double(s.radiance.y) * std::max(0.0, double(s.direction ^ normal)) / double(s.pdf);
            }
        }
        double below = 0.0; // what comes from under the horizon is left to the paths
        constexpr int points = 200000;
        for (int i = 0; i < points; ++i) {
            const V3f d = spiral(i, points);
            if (d.z < 0.f)
                below += double(lights.radiance(d).y) * std::max(0.0, double(d ^ normal)) * 4.0 * pi / points;
        }
        const double expected = double(lights.irradiance(normal).y) - below;
        EXPECT_NEAR(sum / count / expected, 1.0, 0.01);
    }
}

TEST(Lights, keyLightIrradiatesAFacingSurfaceAsMuchAsItSays) {
    KeyLight key;
    key.irradiance = {3.f, 2.f, 1.f};
    for (const float angle : {0.05f, 0.27f, 5.f, 40.f}) {
        key.angularRadiusDegrees = angle;
        const Lights lights(std::make_shared<UniformEnvironment>(V3f(0.f)), key);
        const KeyedRandom random(1, "lights", "test");
        PixelSampler sampler(random, 0, 0);
        V3f sum(0.f);
        for (std::uint32_t i = 0; i < 4096; ++i) {
            sampler.startSample(i);
            const Lights::Sample s = lights.sample(Lights::keyLight, key.direction, sampler.next2());
            sum += s.radiance * (s.direction ^ key.direction) / s.pdf / 4096.f;
        }
        EXPECT_NEAR(sum.x, 3.f, 0.003f) << angle;
        EXPECT_NEAR(sum.z, 1.f, 0.001f) << angle;
    }
}

TEST(Lights, aUniformSkyIrradiatesByPi) {
    const Lights lights(std::make_shared<UniformEnvironment>(V3f(2.f)));
    EXPECT_NEAR(lights.irradiance({0, 0, 1}).x, float(2.0 * pi), 0.02f);
    EXPECT_NEAR(lights.irradiance(V3f(1, 2, -1).normalized()).x, float(2.0 * pi), 0.02f);
}

TEST(Lights, theStudioIsWhiteBalancedAndExposed) {
    const Lights lights = studioLights(UpAxis::z);
    const V3f white = lights.irradiance({0, 0, 1}) / float(pi); // a white card on the floor
    EXPECT_NEAR(white.y, 1.f, 0.15f);
    EXPECT_NEAR(white.x / white.y, 1.f, 0.03f);
    EXPECT_NEAR(white.z / white.y, 1.f, 0.03f);
}

TEST(Lights, refusesImpossibleLight) {
    const auto sky = std::make_shared<UniformEnvironment>(V3f(1.f));
    EXPECT_THROW(Lights(std::make_shared<UniformEnvironment>(V3f(-1.f))), RunError);
    EXPECT_THROW(Lights(std::make_shared<UniformEnvironment>(V3f(NAN))), RunError);
    KeyLight key;
    key.angularRadiusDegrees = 0.f;
    EXPECT_THROW(Lights(sky, key), RunError);
    key = {};
    key.direction = {0, 0, 2};
    EXPECT_THROW(Lights(sky, key), RunError);
    key = {};
    key.irradiance = V3f(-1.f);
    EXPECT_THROW(Lights(sky, key), RunError);
}

} // namespace
} // namespace patina
