#include "render/path_tracer.h"

#include "base/errors.h"
#include "render/displace.h"
#include "render/film.h"
#include "test_scenes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <thread>

namespace patina {
namespace {

using Imath::V3f;

constexpr float pi = float(M_PI);

RenderOptions small(int size, int samples) {
    RenderOptions options;
    options.width = options.height = size;
    options.samples = samples;
    return options;
}

Lights uniformSky(float radiance, std::optional<KeyLight> key = {}) {
    return Lights(std::make_shared<UniformEnvironment>(V3f(radiance)), key);
}

Image picture(const RenderScene& scene, const CameraView& view, const Lights& lights, const RenderOptions& options) {
    Progress quiet;
    const Camera camera = Camera::framed(scene.surface->positions, view, float(options.width) / float(options.height));
    return render(scene, camera, lights, options, quiet).image;
}

struct Spread {
    double mean = 0.0, least = 1e9, most = -1e9;
    int count = 0;
};

/// Over the pixels within `radius` (a part of the picture's width) of its middle.
Spread spreadOf(const Image& image, double radius) {
    Spread s;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (std::hypot(x + 0.5 - 0.5 * image.width, y + 0.5 - 0.5 * image.height) < radius * image.width) {
                const double v = image.rgb(x, y).y;
                s.mean += v, s.least = std::min(s.least, v), s.most = std::max(s.most, v);
                ++s.count;
            }
    s.mean /= s.count;
    return s;
}

// A white surface in a white room disappears.
TEST(PathTracer, whiteFurnaceOnASphere) {
    const SurfaceMesh sphere = sphereMesh(120, 1.f);
    const Image image = picture(sceneOf(sphere, lambert(V3f(1.f))), {}, uniformSky(1.f), small(64, 256));
    const Spread s = spreadOf(image, 0.41); // the sphere's radius is 0.43 of the picture
    EXPECT_NEAR(s.mean, 1.0, 0.002);
    EXPECT_NEAR(s.least, 1.0, 0.03);
    EXPECT_NEAR(s.most, 1.0, 0.03);
}

TEST(PathTracer, greySphereUnderAUniformSkyShowsItsAlbedo) {
    const SurfaceMesh sphere = sphereMesh(120, 1.f);
    const Image image = picture(sceneOf(sphere, lambert({0.2f, 0.5f, 0.8f})), {}, uniformSky(2.f), small(32, 64));
    const V3f middle = image.rgb(16, 16);
    EXPECT_NEAR(middle.x, 0.4f, 0.012f);
    EXPECT_NEAR(middle.y, 1.0f, 0.03f);
    EXPECT_NEAR(middle.z, 1.6f, 0.05f);
    EXPECT_NEAR(spreadOf(image, 0.4).mean, 1.0, 0.005);
}

// Interreflection between the bumps of a white surface gives back what their shadows take.
TEST(PathTracer, whiteFurnaceOnABumpySurfaceNeedsManyBouncesOnly) {
    const SurfaceMesh sphere = sphereMesh(120, 1.f);
    std::vector<float> heights;
    for (const V3f& p : sphere.positions)
        heights.push_back(0.05f * std::sin(12.f * p.x) * std::sin(12.f * p.y) * std::sin(12.f * p.z));
    const SurfaceMesh bumpy = displaced(sphere, heights);
    RenderOptions options = small(48, 64);
    options.maxDepth = 30;
    const Spread s = spreadOf(picture(sceneOf(bumpy, lambert(V3f(1.f))), {}, uniformSky(1.f), options), 0.38);
    // Shading normals and facets disagree a little here, which loses and never makes light.
    EXPECT_NEAR(s.mean, 1.0, 0.01);
    EXPECT_LT(s.most, 1.1);
}

TEST(PathTracer, coarseFacetsWithSmoothNormalsStayLit) {
    const SurfaceMesh coarse = sphereMesh(12, 1.f);
    const Spread s = spreadOf(picture(sceneOf(coarse, lambert(V3f(1.f))), {}, uniformSky(1.f), small(64, 64)), 0.4);
    EXPECT_NEAR(s.mean, 1.0, 0.03);
    EXPECT_GT(s.least, 0.8);
    EXPECT_LT(s.most, 1.1);
}

/// What a BSDF reflects of uniform light, seen at this angle, by the midpoint rule over the hemisphere.
double albedoByQuadrature(const PatinaBsdf& bsdf, double cosine) {
    constexpr int steps = 600;
    const V3f wo(float(std::sqrt(1.0 - cosine * cosine)), 0.f, float(cosine));
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double t = 0.5 * M_PI * (i + 0.5) / steps, p = M_PI * (j + 0.5) / steps;
            const V3f wi(float(std::sin(t) * std::cos(p)), float(std::sin(t) * std::sin(p)), float(std::cos(t)));
            sum += double(bsdf.evaluate(wo, wi).y) * std::cos(t) * std::sin(t);
        }
    return 2.0 * sum * 0.5 * M_PI * M_PI / (double(steps) * steps); // the other half is its mirror image
}

TEST(PathTracer, glossySphereUnderAUniformSkyAgreesWithQuadrature) {
    const SurfaceMesh sphere = sphereMesh(120, 1.f);
    CameraView view;
    view.fieldOfViewDegrees = 1.f; // nearly parallel: the angle of view follows from the place in the picture
    for (const float alpha : {0.1f, 0.25f, 0.7f}) {
        const PatinaBsdf bsdf = copper(alpha);
        const Image image = picture(sceneOf(sphere, bsdf), view, uniformSky(1.f), small(64, 256));
        for (const double place : {0.0, 0.5, 0.8, 0.9}) { // of the sphere's radius, on a ring of pixels
            double mean = 0.0;
            int count = 0;
            for (int y = 0; y < 64; ++y)
                for (int x = 0; x < 64; ++x) {
                    const double r = std::hypot(x - 31.5, y - 31.5) / (0.43 * 64.0);
                    if (std::abs(r - place) < 0.03) {
                        mean += double(image.rgb(x, y).y);
                        ++count;
                    }
                }
            const double expected = albedoByQuadrature(bsdf, std::sqrt(1.0 - place * place));
            ASSERT_GT(count, 3);
            EXPECT_NEAR(mean / count / expected, 1.0, 0.01) << alpha << " at " << place;
            EXPECT_LT(mean / count, 1.005);
        }
    }
}

// A disc of irradiance E at angle t from the normal, wholly above it, irradiates by E cos t.
TEST(PathTracer, keyLightOnAPlaneFollowsTheCosine) {
    const SurfaceMesh square = squareMesh();
    CameraView above;
    above.elevationDegrees = 90.f;
    for (const float radius : {0.27f, 5.f, 20.f})
        for (const float tilt : {0.f, 30.f, 60.f}) {
            KeyLight key;
            const float t = tilt * pi / 180.f;
            key.direction = {std::sin(t), 0.f, std::cos(t)};
            key.angularRadiusDegrees = radius;
            key.irradiance = V3f(2.f);
            const Image image =
                picture(sceneOf(square, lambert(V3f(0.6f))), above, uniformSky(0.f, key), small(16, 64));
            EXPECT_NEAR(spreadOf(image, 0.4).mean / (0.6 / M_PI * 2.0 * std::cos(double(t))), 1.0, 0.005);
        }
}

TEST(PathTracer, openSheetsShowTheSameMaterialFromBehind) {
    const SurfaceMesh square = squareMesh();
    CameraView below;
    below.elevationDegrees = -90.f;
    const Image image = picture(sceneOf(square, lambert(V3f(0.5f))), below, uniformSky(1.f), small(16, 32));
    EXPECT_NEAR(spreadOf(image, 0.4).mean, 0.5, 0.01);
}

// From a point of the floor at distance D from its middle, a sphere of radius R that stands on the floor takes
// (R/D)² cos = R³ / D³ of a uniform sky's irradiance.
TEST(PathTracer, contactShadowOfABlackSphereIsTheFormFactor) {
    const SurfaceMesh sphere = sphereMesh(100, 1.f, {0, 0, 1});
    RenderScene scene = sceneOf(sphere, lambert(V3f(0.f)));
    scene.ground = true;
    scene.groundAlbedo = 0.5f;
    CameraView view;
    view.elevationDegrees = 50.f;
    view.fill = 0.5f;
    const RenderOptions options = small(96, 64);
    const Camera camera = Camera::framed(sphere.bounds(), view, 1.f);
    Progress quiet;
    const Image image = render(scene, camera, uniformSky(1.f), options, quiet).image;
    double error = 0.0, most = 0.0;
    int count = 0;
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
            const CameraRay ray = camera.ray((float(x) + 0.5f) / 96.f, (float(y) + 0.5f) / 96.f);
            const V3f toCentre = V3f(0, 0, 1) - ray.origin;
            const float along = toCentre ^ ray.direction;
            if (toCentre.length2() - along * along < 1.1f || ray.direction.z > -0.05f)
                continue;
            const V3f p = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
            if (std::hypot(p.x, p.y) > 2.2f) // beyond, the floor fades into the backdrop
                continue;
            const double distance = std::sqrt(double(p.length2()) + 1.0);
            const double expected = 0.5 * (1.0 - 1.0 / (distance * distance * distance));
            const double difference = double(image.rgb(x, y).y) - expected;
            error += difference, most = std::max(most, std::abs(difference));
            ++count;
        }
    ASSERT_GT(count, 500);
    EXPECT_NEAR(error / count, 0.0, 0.002);
    EXPECT_LT(most, 0.05);
}

// A floor in the studio: smooth where nothing shadows it.
TEST(PathTracer, samplesEndWhereTheNoiseDoes) {
    const SurfaceMesh sphere = sphereMesh(40, 1.f, {0, 0, 1});
    RenderScene scene = sceneOf(sphere, copper());
    scene.ground = true;
    const Camera camera = Camera::framed(sphere.positions, {}, 1.f);
    const Lights lights = studioLights(UpAxis::z);
    Progress quiet;
    const auto take = [&](float noise, int samples, double seconds = 0.0) {
        RenderOptions options = small(48, samples);
        options.noise = noise;
        options.seconds = seconds;
        return render(scene, camera, lights, options, quiet);
    };
    constexpr float allowed = 10.f;
    const Rendering all = take(0.f, 64), some = take(allowed, 64), none = take(1e6f, 64);
    EXPECT_EQ(all.samplesPerPixel, 64.0);
    EXPECT_EQ(none.samplesPerPixel, 8.0);
    EXPECT_EQ(take(1e-9f, 64).image.pixels, all.image.pixels) << "no noise is allowed, no sample is left out";
    EXPECT_EQ(take(1e6f, 64, 1e6).image.pixels, all.image.pixels) << "time, not noise, is what ends it";
    // With all blocks stopped after 8 it is the picture of 8 samples.
    const Image eight = take(0.f, 8).image;
    for (std::size_t i = 0; i < eight.pixels.size(); ++i)
        ASSERT_NEAR(none.image.pixels[i], eight.pixels[i], 1e-5f * (1.f + eight.pixels[i]));
    EXPECT_GT(some.samplesPerPixel, 8.0);
    EXPECT_LT(some.samplesPerPixel, 48.0);
    EXPECT_LT(some.rays, all.rays);
    // Where samples were left out the two differ by the noise allowed (and that of the longer picture).
    const Image few = displayImage(some.image, {ViewTransform::srgb, 0.f, false});
    const Image many = displayImage(take(0.f, 512).image, {ViewTransform::srgb, 0.f, false});
    double squares = 0.0;
    int quieter = 0;
    for (std::size_t i = 0; i < few.pixels.size(); ++i)
        if (some.image.pixels[i] != all.image.pixels[i]) {
            squares += std::pow(255.0 * (double(few.pixels[i]) - double(many.pixels[i])), 2);
            ++quieter;
        }
    ASSERT_GT(quieter, 500);
    EXPECT_LT(std::sqrt(squares / quieter), allowed);
}

TEST(PathTracer, sameBitsOnAnyNumberOfThreads) {
    const SurfaceMesh sphere = sphereMesh(40, 1.f, {0, 0, 1});
    RenderScene scene = sceneOf(sphere, copper());
    scene.ground = true;
    const auto render_ = [&](int threads) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
        tbb::task_arena arena(threads);
        Image image;
        arena.execute([&] { image = picture(scene, {}, studioLights(UpAxis::z), small(50, 8)); });
        return image.pixels;
    };
    const std::vector<float> one = render_(1);
    EXPECT_EQ(one, render_(2));
    EXPECT_EQ(one, render_(4));
    RenderOptions other = small(50, 8);
    other.seed = 1;
    EXPECT_NE(one, picture(scene, {}, studioLights(UpAxis::z), other).pixels);
}

TEST(PathTracer, studioPictureIsWellExposed) {
    const SurfaceMesh sphere = sphereMesh(60, 1.f, {0, 0, 1});
    RenderScene scene = sceneOf(sphere, copper(0.25f));
    scene.ground = true;
    const Image image = picture(scene, {}, studioLights(UpAxis::z), small(64, 16));
    int clipped = 0, black = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            clipped += image.rgb(x, y).y > 2.f;
            black += image.rgb(x, y).y < 0.005f;
        }
    EXPECT_LT(clipped, 64 * 64 / 50); // highlights only
    EXPECT_EQ(black, 0);
    for (const int x : {0, 63}) { // the backdrop is a neutral grey
        const V3f corner = image.rgb(x, 0);
        EXPECT_GT(corner.y, 0.08f);
        EXPECT_LT(corner.y, 0.6f);
        EXPECT_NEAR(corner.x / corner.z, 1.f, 0.06f);
    }
}

/// Counts, and cancels on the way.
class CancellingProgress : public Progress {
  public:
    void update(double fraction) override {
        EXPECT_EQ(std::this_thread::get_id(), thread_);
        if (fraction > 0.2)
            cancel();
    }

  private:
    std::thread::id thread_ = std::this_thread::get_id();
};

TEST(PathTracer, stopsWhenAskedTo) {
    const SurfaceMesh square = squareMesh();
    const RenderScene scene = sceneOf(square, lambert(V3f(0.5f)));
    CancellingProgress progress;
    const Camera camera = Camera::framed(square.bounds(), {}, 1.f);
    EXPECT_THROW(render(scene, camera, uniformSky(1.f), small(512, 16), progress), Interrupted);
}

TEST(PathTracer, refusesWhatItCannotRender) {
    const SurfaceMesh square = squareMesh();
    const RenderScene scene = sceneOf(square, lambert(V3f(0.5f)));
    const Lights sky = uniformSky(1.f);
    EXPECT_THROW(picture(scene, {}, sky, small(0, 4)), RunError);
    EXPECT_THROW(picture(scene, {}, sky, small(4, 0)), RunError);
    RenderOptions shallow = small(4, 1);
    shallow.maxDepth = 0;
    EXPECT_THROW(picture(scene, {}, sky, shallow), RunError);
    Progress quiet;
    const Camera camera = Camera::framed(square.bounds(), {}, 1.f);
    EXPECT_THROW(render(RenderScene{}, camera, sky, small(4, 1), quiet), RunError);
    SurfaceMesh bare = square;
    bare.normals.clear();
    EXPECT_THROW(render(sceneOf(bare, lambert(V3f(0.5f))), camera, sky, small(4, 1), quiet), RunError);
}

} // namespace
} // namespace patina
