#include "render/area_light.h"

#include "base/errors.h"
#include "render/path_tracer.h"
#include "render/pixel_sampler.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3f;

constexpr double pi = M_PI;

AreaLight disc(float radius, const V3f& centre) {
    AreaLight light;
    light.shape = AreaLight::Shape::disc;
    light.centre = centre;
    light.frame = frameAround({0, 0, -1});
    light.halfWidth = radius;
    return light;
}

AreaLight rectangle(float halfWidth, float halfHeight, const V3f& centre) {
    AreaLight light;
    light.centre = centre;
    light.frame = {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    light.halfWidth = halfWidth;
    light.halfHeight = halfHeight;
    return light;
}

/// Irradiance at the origin facing +z, by the set's own sampling.
double sampled(const AreaLightSet& set, int count = 1 << 14) {
    const KeyedRandom random(1, "area", "test");
    PixelSampler sampler(random, 0, 0);
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sampler.startSample(std::uint32_t(i));
        const auto s = set.sample(V3f(0.f), {0, 0, 1}, sampler.next2());
        if (s.pdf > 0.f)
            sum += double(s.radiance.y) * std::max(0.f, s.direction.z) / double(s.pdf);
    }
    return sum / count;
}

/// Of a surface element to a parallel disc of radius r, h above it and a aside of it (Howell's catalogue, B-13):
/// 1/2 (1 - (Z - 2 R²) / sqrt(Z² - 4 R²)) with H = h/a, R = r/a, Z = 1 + H² + R².
double discFormFactor(double r, double h, double a) {
    const double H = h / a, R = r / a, Z = 1.0 + H * H + R * R;
    return 0.5 * (1.0 - (Z - 2.0 * R * R) / std::sqrt(Z * Z - 4.0 * R * R));
}

/// Of a surface element to a parallel rectangle a × b with a corner straight above it at c (catalogue, B-3).
double cornerFormFactor(double a, double b, double c) {
    const double A = a / c, B = b / c, p = std::sqrt(1.0 + A * A), q = std::sqrt(1.0 + B * B);
    return (A / p * std::atan(B / p) + B / q * std::atan(A / q)) / (2.0 * pi);
}

TEST(AreaLight, ADiscIrradiatesByItsFormFactor) {
    // Straight above: E = pi L r² / (r² + h²).
    for (const double h : {0.5, 1.0, 3.0}) {
        const AreaLightSet set({disc(1.f, {0, 0, float(h)})});
        const double expected = pi / (1.0 + h * h);
        EXPECT_NEAR(double(set.irradiance(V3f(0.f), {0, 0, 1}).y) / expected, 1.0, 0.003) << h;
        EXPECT_NEAR(sampled(set) / expected, 1.0, 0.002) << h;
    }
    for (const double aside : {0.5, 2.0}) {
        const AreaLightSet set({disc(1.f, {float(aside), 0, 1.5f})});
        const double expected = pi * discFormFactor(1.0, 1.5, aside);
        EXPECT_NEAR(double(set.irradiance(V3f(0.f), {0, 0, 1}).y) / expected, 1.0, 0.003) << aside;
        EXPECT_NEAR(sampled(set) / expected, 1.0, 0.003) << aside;
    }
}

TEST(AreaLight, ARectangleIrradiatesByItsFormFactor) {
    const AreaLightSet set({rectangle(2.f, 0.5f, {0, 0, 1})});
    const double expected = pi * 4.0 * cornerFormFactor(2.0, 0.5, 1.0);
    EXPECT_NEAR(double(set.irradiance(V3f(0.f), {0, 0, 1}).y) / expected, 1.0, 0.003);
    EXPECT_NEAR(sampled(set) / expected, 1.0, 0.005);
}

TEST(AreaLight, SeveralLightsAddUpAndOneThatTurnsItsBackGivesNothing) {
    AreaLight back = rectangle(1.f, 1.f, {0, 0, 0.7f});
    back.frame = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    back.radiance = V3f(100.f);
    const AreaLightSet set({disc(1.f, {2.f, 0, 1.5f}), rectangle(2.f, 0.5f, {0, 0, 1}), back});
    const double expected = pi * (discFormFactor(1.0, 1.5, 2.0) + 4.0 * cornerFormFactor(2.0, 0.5, 1.0));
    EXPECT_NEAR(sampled(set, 1 << 16) / expected, 1.0, 0.005);
}

// What sample() draws, hit() finds at the same distance with the same radiance and density.
TEST(AreaLight, ASampleReportsWhatARayThatWayMeets) {
    AreaLight soft = rectangle(1.f, 2.f, {-1.f, 0.3f, 2.f});
    soft.softEdge = 0.3f;
    soft.dimming = 0.35f;
    const AreaLightSet set({disc(0.8f, {1.f, 0.5f, 1.5f}), soft});
    const V3f position(0.2f, -0.1f, 0.1f), normal = V3f(0.3f, -0.2f, 1.f).normalized();
    const KeyedRandom random(2, "area", "test");
    PixelSampler sampler(random, 0, 0);
    int found = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        sampler.startSample(i);
        const auto s = set.sample(position, normal, sampler.next2());
        ASSERT_GT(s.pdf, 0.f);
        for (std::size_t k = 0; k < 2; ++k)
            if (const auto hit = set.hit(k, position, normal, s.direction))
                if (std::abs(hit->distance / s.distance - 1.f) < 1e-4f && s.radiance.y > 0.02f) {
                    ++found;
                    EXPECT_NEAR(hit->pdf / s.pdf, 1.f, 2e-3f);
                    EXPECT_NEAR(hit->radiance.y, s.radiance.y, 5e-3f);
                    EXPECT_FALSE(set.hit(k, position, normal, s.direction, 0.5f * s.distance)) << "nearer than it is";
                }
    }
    EXPECT_GT(found, 1800); // the rest are on the soft edge's darkest part, or on the disc's rim
}

// From afar all points of a rectangle with a soft edge say the same: it is sampled as densely as it shines.
TEST(AreaLight, ASoftEdgeAddsNoNoise) {
    for (const float edge : {0.1f, 0.35f, 1.f}) {
        AreaLight soft = rectangle(1.f, 2.f, {0, 0, 200.f});
        soft.softEdge = edge;
        const AreaLightSet set({soft});
        const KeyedRandom random(2, "area", "edge");
        PixelSampler sampler(random, 0, 0);
        const float expected = 8.f * (1.f - 0.5f * edge) * (1.f - 0.5f * edge) / (200.f * 200.f);
        for (std::uint32_t i = 0; i < 2000; ++i) {
            sampler.startSample(i);
            const auto s = set.sample(V3f(0.f), {0, 0, 1}, sampler.next2());
            if (s.radiance.y > 1e-4f) {
                EXPECT_NEAR(s.radiance.y * s.direction.z / s.pdf / expected, 1.f, 1e-3f) << edge;
            }
        }
        EXPECT_NEAR(set.irradiance(V3f(0.f), {0, 0, 1}).y / expected, 1.f, 1e-3f) << edge;
    }
}

TEST(AreaLight, RefusesImpossibleLight) {
    AreaLight light = disc(0.f, {0, 0, 1});
    EXPECT_THROW(AreaLightSet({light}), RunError);
    light = disc(1.f, {0, 0, 1});
    light.radiance = V3f(-1.f);
    EXPECT_THROW(AreaLightSet({light}), RunError);
    light.radiance = V3f(NAN);
    EXPECT_THROW(AreaLightSet({light}), RunError);
}

/// The mean of the middle of a picture of a square from straight above.
double middleOf(const PatinaBsdf& bsdf, const Lights& lights, int samples, float elevation = 89.f) {
    const SurfaceMesh square = squareMesh();
    RenderScene scene;
    scene.surface = &square;
    scene.material = [bsdf](const SurfacePoint&, const V3f&) { return bsdf; };
    scene.ground = false;
    scene.background = V3f(0.f);
    CameraView view;
    view.elevationDegrees = elevation;
    RenderOptions options;
    options.width = options.height = 16;
    options.samples = samples;
    Progress quiet;
    // A small patch around the middle.
    const Camera camera = Camera::aimed(V3f(0.f), 0.2f, view, 1.f);
    const Image image = render(scene, camera, lights, options, quiet).image;
    double sum = 0.0;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            sum += double(image.rgb(x, y).y) / 256.0;
    return sum;
}

Lights dark() {
    return Lights(std::make_shared<UniformEnvironment>(V3f(0.f)));
}

TEST(AreaLight, APictureOfAWhiteCardUnderADiscIsItsIrradiance) {
    Lights lights = dark();
    lights.setAreaLights(AreaLightSet({disc(1.f, {1.f, 0, 1.5f})}), 1.5f);
    // L = albedo / pi E, E = pi F.
    EXPECT_NEAR(middleOf(lambert(V3f(0.6f)), lights, 64) / (0.6 * discFormFactor(1.0, 1.5, 1.0)), 1.0, 0.005);
}

// Far away, a disc is the key light of the same angular radius: for a glossy metal, half sampled by the light and half
// by the lobe, both give the same picture.
TEST(AreaLight, FarAwayADiscIsAKeyLight) {
    KeyLight key;
    key.direction = V3f(0.5f, 0.2f, 1.f).normalized();
    key.angularRadiusDegrees = 12.f;
    key.irradiance = V3f(2.f);
    const Lights far(std::make_shared<UniformEnvironment>(V3f(0.f)), key);
    AreaLight lamp;
    lamp.shape = AreaLight::Shape::disc;
    const float away = 2000.f;
    lamp.centre = key.direction * away;
    lamp.frame = frameAround(-key.direction);
    lamp.halfWidth = away * std::tan(12.f * float(pi) / 180.f);
    lamp.radiance = key.radiance();
    Lights near = dark();
    near.setAreaLights(AreaLightSet({lamp}), away);
    for (const float alpha : {0.15f, 0.5f}) {
        const double expected = middleOf(copper(alpha), far, 256, 60.f);
        ASSERT_GT(expected, 1e-3);
        EXPECT_NEAR(middleOf(copper(alpha), near, 256, 60.f) / expected, 1.0, 0.02) << alpha;
    }
}

TEST(AreaLight, MoreLightsThanASetTakesAreAnError) {
    std::vector<AreaLight> lights(AreaLightSet::mostLights, disc(1.f, {0, 0, 3}));
    EXPECT_NO_THROW(AreaLightSet{lights});
    lights.push_back(lights.back());
    try {
        AreaLightSet set(lights);
        FAIL();
    } catch (const RunError& error) {
        EXPECT_NE(std::string(error.what()).find("there are 65"), std::string::npos) << error.what();
    }
}

TEST(AreaLight, TheStudioSetIsAsBrightAsTheStudioFarAway) {
    Imath::Box3f object(V3f(-1.f), V3f(1.f));
    const Lights far = studioLights(UpAxis::z), near = studioSet(UpAxis::z, object);
    // A white card on the floor under the object's middle is a little nearer to nothing than infinitely far lights are.
    const V3f up(0, 0, 1), here = near.irradiance(up, {0, 0, -1}) / float(pi), there = far.irradiance(up) / float(pi);
    EXPECT_NEAR(here.y / there.y, 1.f, 0.25f);
    EXPECT_NEAR(here.x / here.y, 1.f, 0.03f);
    EXPECT_NEAR(here.z / here.y, 1.f, 0.03f);
    EXPECT_THROW(studioSet(UpAxis::z, Imath::Box3f(V3f(1.f), V3f(1.f))), RunError);
}

} // namespace
} // namespace patina
