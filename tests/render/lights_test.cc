#include "render/lights.h"

#include "base/errors.h"
#include "base/vector_lanes.h"
#include "optics/patina_bsdf.h"
#include "render/image_environment.h"
#include "render/light_tables.h"
#include "render/pixel_sampler.h"
#include "render/sky_environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace patina {
namespace {

using Imath::V2f;
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

// Pearson's chi² of drawn directions against the density: 400,000 in 8 × 16 patches of equal solid angle.
TEST(Lights, samplesFollowTheirDensity) {
    const Lights studio = studioLights(UpAxis::z), uniform(std::make_shared<UniformEnvironment>(V3f(1.f)));
    const KeyedRandom random(1, "lights", "chi square");
    constexpr int rows = 8, columns = 16, samples = 400000, fine = 48; // whole cells of the tables
    const auto patchOf = [&](const V3f& d) {
        const double turn = std::atan2(double(d.y), double(d.x)) / (2.0 * pi);
        return std::min(int(0.5 * (d.z + 1.0) * rows), rows - 1) * columns +
               std::min(int((turn < 0.0 ? turn + 1.0 : turn) * columns), columns - 1);
    };
    for (const Lights* lights : {&studio, &uniform})
        for (const V3f& normal :
             {V3f(0, 0, 1), V3f(0.7f, -0.5f, 0.2f).normalized(), V3f(-0.2f, 0.3f, -0.9f).normalized()}) {
            std::vector<double> expected(rows * columns, 0.0), counts(rows * columns, 0.0);
            for (int i = 0; i < rows * fine; ++i)
                for (int j = 0; j < columns * fine; ++j) {
                    const double z = 2.0 * (i + 0.5) / (rows * fine) - 1.0,
                                 phi = 2.0 * pi * (j + 0.5) / (columns * fine);
                    const double r = std::sqrt(1.0 - z * z);
                    const V3f d(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z));
                    expected[std::size_t(i / fine * columns + j / fine)] +=
                        double(lights->pdf(Lights::environment, normal, d)) * samples * 4.0 * pi /
                        (rows * columns * fine * fine);
                }
            for (int i = 0; i < samples; ++i) {
                const auto u = random.uniforms(0, i, 0, 0);
                const auto drawn = lights->sample(Lights::environment, normal, {float(u[0]), float(u[1])});
                if (drawn.pdf > 0.f)
                    counts[std::size_t(patchOf(drawn.direction))] += 1.0;
            }
            double chi2 = 0.0, pooledExpected = 0.0, pooled = 0.0;
            int freedom = -1;
            for (std::size_t i = 0; i < counts.size(); ++i) {
                if (expected[i] < 5.0) {
                    pooledExpected += expected[i], pooled += counts[i];
                    continue;
                }
                chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
                ++freedom;
            }
            EXPECT_LT(std::abs(pooled - pooledExpected), 5.0 * std::sqrt(pooledExpected) + 5.0);
            // Six cases at a significance of 0.01 together.
            EXPECT_LT((chi2 - freedom) / std::sqrt(2.0 * freedom), 3.3);
        }
}

// Light alone, BSDF alone and both together (power heuristic) are three estimates of one integral.
TEST(Lights, multipleImportanceSamplingKeepsTheMean) {
    const Lights lights = studioLights(UpAxis::z);
    Appearance look; // matt under a satin gloss
    look.diffuse = V3f(0.3f);
    look.lobes.resize(1);
    look.lobes[0].colour = V3f(0.3f);
    look.lobes[0].edgeColour = V3f(0.6f);
    look.lobes[0].alpha = 0.35f;
    const PatinaBsdf bsdf(look);
    const V3f normal = V3f(0.2f, -0.6f, 0.75f).normalized();
    const Frame frame = frameAround(normal);
    const SeenBsdf seen(bsdf, V3f(0.5f, 0.1f, 0.85f).normalized());
    const KeyedRandom random(1, "lights", "mis");
    const auto density = [&](const V3f& d) { return lights.pdf(Lights::environment, normal, d); };
    const auto square = [](float x) { return double(x) * double(x); };
    constexpr int samples = 400000;
    double ofLights = 0.0, ofBsdf = 0.0, ofBoth = 0.0;
    for (int i = 0; i < samples; ++i) {
        const auto u = random.uniforms(0, i, 0, 0), v = random.uniforms(1, i, 0, 0);
        const auto light = lights.sample(Lights::environment, normal, {float(u[0]), float(u[1])});
        const V3f wi = frame.toLocal(light.direction);
        const BsdfValue f = seen.evaluate(wi);
        if (light.pdf > 0.f && f.pdf > 0.f) {
            const double part = double(f.value.y) * double(wi.z) * double(light.radiance.y) / double(light.pdf);
            ofLights += part;
            ofBoth += part * square(light.pdf) / (square(light.pdf) + square(f.pdf));
        }
        const BsdfSample drawn = seen.sample({float(v[0]), float(v[1]), float(v[2])});
        if (drawn.pdf > 0.f && drawn.wi.z > 0.f) {
            const V3f d = frame.toWorld(drawn.wi);
            // The set's floor is left to the BSDF: light sampling never goes there.
            const double part = double(drawn.weight.y) * double(lights.radiance(Lights::environment, d).y);
            const float other = density(d);
            ofBsdf += other > 0.f ? part : 0.0;
            ofBoth += other > 0.f ? part * square(drawn.pdf) / (square(drawn.pdf) + square(other)) : 0.0;
        }
    }
    EXPECT_NEAR(ofLights / ofBsdf, 1.0, 0.01);
    EXPECT_NEAR(ofBoth / ofLights, 1.0, 0.01);
}

// Lanes of all three kinds against one at a time, to the bit.
void expectLanesAgree(const Lights& lights) {
    constexpr int count = 1003, room = 1008;
    VectorLanes normals, directions, light, lightByChance;
    for (VectorLanes* lanes : {&normals, &directions, &light, &lightByChance})
        lanes->resize(room);
    std::vector<float> u(room), v(room), density(room), densityByChance(room);
    std::vector<int> tables(room);
    const KeyedRandom random(5, "lights", "lanes");
    PixelSampler sampler(random, 0, 0);
    for (int i = 0; i < count; ++i) {
        sampler.startSample(std::uint32_t(i));
        const V2f position = sampler.next2();
        normals.set(std::size_t(i), i < 2 ? V3f(0, 0, i == 0 ? 1.f : -1.f) : spiral(i, count));
        u[std::size_t(i)] = i % 50 == 7 ? 0.99999994f : i % 50 == 9 ? 0.f : position.x;
        v[std::size_t(i)] = i % 30 == 7 ? 0.99999994f : i % 30 == 9 ? 0.f : position.y;
    }
    const VectorLanes& normal = normals;
    const VectorLanes& chance = normals; // any directions
    lights.aim(count, numbersOf(normal), tables.data());
    lights.sampleEnvironment({count, tables.data(), u.data(), v.data(), numbersOf(directions), density.data()},
                             numbersOf(light));
    lights.environmentRadiance({count, numbersOf(chance), numbersOf(lightByChance)});
    std::vector<int> turned(tables.rbegin() + (room - count), tables.rend());
    turned.resize(room);
    lights.environmentDensity({count, turned.data(), numbersOf(chance), densityByChance.data()});
    int lit = 0;
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(tables[i], lights.aim(normal[i]).table);
        const Lights::Sample one = lights.sample(Lights::environment, normal[i], {u[i], v[i]});
        ASSERT_EQ(directions[i], one.direction) << i;
        ASSERT_EQ(light[i], one.radiance) << i;
        ASSERT_EQ(density[i], one.pdf) << i;
        ASSERT_EQ(lightByChance[i], lights.radiance(Lights::environment, chance[i])) << i;
        ASSERT_EQ(densityByChance[i], lights.pdf(Lights::environment, {turned[i], {}}, chance[i])) << i;
        ASSERT_GT(one.pdf, 0.f);
        lit += densityByChance[i] > 0.f;
    }
    EXPECT_GT(lit, count / 3);
}

TEST(Lights, lanesDrawWhatSamplesDraw) {
    Image panorama(64, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            panorama.setRgb(x, y, {0.01f * float(x), 0.02f * float(y), x == 20 && y == 9 ? 900.f : 0.3f});
    expectLanesAgree(Lights(std::make_shared<ImageEnvironment>(panorama, UpAxis::y, 33.f), {}, UpAxis::y));
    expectLanesAgree(studioLights(UpAxis::z, 70.f));
    expectLanesAgree(daylight({}, UpAxis::y));
    expectLanesAgree(Lights(std::make_shared<UniformEnvironment>(V3f(1, 2, 3)), {}, UpAxis::z, true));
}

// Every cell is drawn by exactly the numbers that its chance is worth, those at the ends of rows included.
TEST(LightTables, aNumberFindsTheCellThatItFallsInto) {
    constexpr int columns = LightTables::columns, rows = LightTables::rows;
    std::vector<float> luminances(std::size_t(rows) * columns, 1.f);
    for (std::size_t i = 0; i < luminances.size(); ++i)
        luminances[i] += float(i * 2654435761u % 97u) * (i % 16 == 15 ? 30.f : 1.f);
    const LightTables tables(luminances, Frame{}, false);
    constexpr int steps = 1200;
    for (const int table : {0, 77, 179}) {
        double sum = 0.0; // of solid angles over densities' means: how much of the sphere the numbers cover
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const LightTables::Sample s =
                    tables.sample(table, {(float(i) + 0.5f) / steps, (float(j) + 0.5f) / steps});
                ASSERT_GT(s.pdf, 0.f);
                sum += 1.0 / double(s.pdf);
            }
        EXPECT_NEAR(sum / (double(steps) * steps * 4.0 * double(pi)), 1.0, 0.01);
    }
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
