// What renderers get wrong: bound indirect light, the terminator on coarse normals, leaks at seams, rounds of samples.

#include "render/dice.h"
#include "render/displace.h"
#include "render/path_tracer.h"
#include "surface/ray_scene.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {
namespace {

using Imath::V3f;
using Imath::V3i;

Lights uniform(float radiance, std::optional<KeyLight> key = {}) {
    return Lights(std::make_shared<UniformEnvironment>(V3f(radiance)), key);
}

RenderOptions squareOf(int size, int samples) {
    RenderOptions options;
    options.width = options.height = size;
    options.samples = samples;
    return options;
}

double meanInside(const Image& image) {
    double sum = 0.0;
    int count = 0;
    for (int y = image.height / 3; y < image.height * 2 / 3; ++y)
        for (int x = image.width / 3; x < image.width * 2 / 3; ++x, ++count)
            sum += double(image.rgb(x, y).y);
    return sum / count;
}

// White hollows under a bright sky are as bright as the sky, if all light between them counts.
TEST(PathFaults, BoundOnIndirectLightDarkensAndZeroIsNone) {
    const SurfaceMesh sphere = sphereMesh(100, 1.f);
    std::vector<float> heights;
    for (const V3f& p : sphere.positions)
        heights.push_back(0.1f * std::sin(12.f * p.x) * std::sin(12.f * p.y) * std::sin(12.f * p.z));
    const SurfaceMesh bumpy = displaced(sphere, heights);
    const Camera camera = Camera::framed(bumpy.positions, {}, 1.f);
    const auto meanOf = [&](float bound) {
        RenderOptions options = squareOf(32, 64);
        options.maxDepth = 30;
        options.indirectClamp = bound;
        Progress quiet;
        return meanInside(render(sceneOf(bumpy, lambert(V3f(1.f))), camera, uniform(40.f), options, quiet).image);
    };
    const double free = meanOf(0.f);
    EXPECT_NEAR(free / 40.0, 1.0, 0.02);
    EXPECT_LT(meanOf(6.f), 0.97 * free) << "the bias that --clamp has";
    EXPECT_NEAR(meanOf(1e6f), free, 1e-3 * free) << "out of reach";
}

// A key light from the side on a sphere of facets 15 degrees wide: as the cosine of the smooth normal, to the
// terminator.
TEST(PathFaults, ShadowTerminatorOnCoarseNormalsFollowsTheCosine) {
    const SurfaceMesh coarse = sphereMesh(12, 1.f);
    KeyLight key;
    key.direction = V3f(1.f, 0.f, 0.15f).normalized();
    key.angularRadiusDegrees = 0.5f;
    key.irradiance = V3f(3.f);
    CameraView view;
    view.elevationDegrees = 0.f;
    view.fieldOfViewDegrees = 1.f; // nearly parallel: normals follow from places
    constexpr int size = 96;
    const Camera camera = Camera::framed(coarse.positions, view, 1.f);
    Progress quiet;
    const Image image =
        render(sceneOf(coarse, lambert(V3f(0.8f))), camera, uniform(0.f, key), squareOf(size, 64), quiet).image;
    double error = 0.0;
    int lit = 0, blackened = 0, leaking = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            // The view is from -y: x to the right, z up.
            const float px = (float(x) + 0.5f - 0.5f * size) / (0.43f * size);
            const float pz = (0.5f * size - float(y) - 0.5f) / (0.43f * size);
            const float r2 = px * px + pz * pz;
            if (r2 > 0.8f)
                continue;
            const float cosine = V3f(px, -std::sqrt(1.f - r2), pz) ^ key.direction;
            const double expected = 0.8 / M_PI * 3.0 * std::max(0.0, double(cosine));
            const double got = double(image.rgb(x, y).y);
            if (cosine > 0.2f) {
                ++lit;
                error += std::abs(got - expected) / expected;
                blackened += got < 0.5 * expected;
            }
            leaking += cosine < -0.15f && got > 0.02;
        }
    ASSERT_GT(lit, 1000);
    EXPECT_EQ(blackened, 0);
    EXPECT_EQ(leaking, 0);
    EXPECT_LT(error / lit, 0.06) << "facets are up to 2 % of the radius off the sphere";
}

// From inside a shell that UVs cut open, diced and displaced, no ray gets out through an edge. (A ray aimed at a vertex
// itself does so at one in a hundred: Embree's edge tests round each on its own. Chance rays come that near to
// one about once in 10^8, as estimated from the rounding.)
TEST(PathFaults, NoLightLeaksThroughSeamsAndDicedPatches) {
    const SurfaceMesh shell = sphereMesh(12, 1.f);
    // Every triangle with vertices of its own: a seam along each edge.
    SurfaceMesh cut;
    for (const V3i& t : shell.triangles) {
        const int first = int(cut.positions.size());
        for (int i = 0; i < 3; ++i) {
            cut.positions.push_back(shell.positions[std::size_t(t[i])]);
            cut.normals.push_back(shell.normals[std::size_t(t[i])]);
        }
        cut.triangles.emplace_back(first, first + 1, first + 2);
    }
    CameraView view;
    view.elevationDegrees = 20.f;
    DiceOptions dice;
    dice.pictureHeight = 96;
    SurfaceMesh fine = diced(cut, Camera::aimed(V3f(0.f, -0.94f, 0.34f), 1.2f, view, 1.f), dice);
    std::vector<float> heights;
    for (const V3f& p : fine.positions)
        heights.push_back(0.03f * std::sin(40.f * p.x) * std::sin(40.f * p.z));
    fine = displaced(fine, heights);
    ASSERT_GT(fine.triangles.size(), 20000u);
    const RayScene rays(fine.positions, fine.triangles);
    constexpr float infinite = std::numeric_limits<float>::infinity();
    RayBatch batch;
    HitBatch hits;
    std::size_t leaks = 0, leaksOfPackets = 0;
    for (const V3i& t : fine.triangles)
        for (int i = 0; i < 3; ++i) {
            const V3f& a = fine.positions[std::size_t(t[i])];
            const V3f& b = fine.positions[std::size_t(t[(i + 1) % 3])];
            batch.count = 0;
            for (const float along : {0.37f, 0.5f}) {
                const V3f direction = (a * (1.f - along) + b * along).normalized();
                leaks += !rays.intersect(V3f(0.f), direction);
                batch.add(V3f(0.f), direction, infinite);
            }
            rays.intersect(batch, false, hits);
            leaksOfPackets += (hits.triangle[0] < 0) + (hits.triangle[1] < 0);
        }
    EXPECT_EQ(leaks, 0u);
    EXPECT_EQ(leaksOfPackets, 0u);
}

// A stack: a clear coat over a body lobe over something diffuse, against quadrature.
TEST(PathFaults, LayeredSphereAgreesWithQuadratureToHalfAPercent) {
    Appearance look;
    look.diffuse = {0.05f, 0.3f, 0.2f};
    look.lobes.resize(2);
    look.lobes[0].colour = {0.5f, 0.35f, 0.3f};
    look.lobes[0].edgeColour = V3f(0.6f);
    look.lobes[0].alpha = 0.3f;
    look.lobes[1].colour = V3f(0.04f);
    look.lobes[1].edgeColour = V3f(1.f);
    look.lobes[1].air = 0.04f;
    look.lobes[1].airEdge = 1.f;
    look.lobes[1].alpha = 0.15f;
    const PatinaBsdf bsdf(look);
    const SurfaceMesh sphere = sphereMesh(200, 1.f);
    CameraView view;
    view.fieldOfViewDegrees = 1.f;
    constexpr int size = 64;
    const Camera camera = Camera::framed(sphere.positions, view, 1.f);
    Progress quiet;
    const Image image = render(sceneOf(sphere, bsdf), camera, uniform(1.f), squareOf(size, 1024), quiet).image;
    for (const double place : {0.0, 0.5, 0.8}) {
        double mean = 0.0, expected = 0.0;
        int count = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double r = std::hypot(x - 31.5, y - 31.5) / (0.43 * size);
                if (std::abs(r - place) >= 0.03)
                    continue;
                ++count;
                mean += double(image.rgb(x, y).y);
            }
        ASSERT_GT(count, 3);
        constexpr int steps = 800;
        const V3f wo(float(place), 0.f, float(std::sqrt(1.0 - place * place)));
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const double t = 0.5 * M_PI * (i + 0.5) / steps, p = M_PI * (j + 0.5) / steps;
                const V3f wi(float(std::sin(t) * std::cos(p)), float(std::sin(t) * std::sin(p)), float(std::cos(t)));
                expected += double(bsdf.evaluate(wo, wi).y) * std::cos(t) * std::sin(t);
            }
        expected *= M_PI * M_PI / (double(steps) * steps);
        EXPECT_NEAR(mean / count / expected, 1.0, 0.005) << "at " << place;
    }
}

// Camera rays go in packets, and rounds of a time-limited picture end where packets do.
TEST(PathFaults, RoundsOfSamplesGiveTheBitsOfAllAtOnce) {
    const SurfaceMesh sphere = sphereMesh(40, 1.f, {0, 0, 1});
    RenderScene scene = sceneOf(sphere, copper());
    scene.ground = true;
    const Camera camera = Camera::framed(sphere.positions, {}, 1.f);
    Progress quiet;
    for (const int samples : {1, 5, 64, 100}) {
        RenderOptions options = squareOf(21, samples);
        const Image all = render(scene, camera, studioLights(UpAxis::z), options, quiet).image;
        options.seconds = 1e6;
        EXPECT_EQ(render(scene, camera, studioLights(UpAxis::z), options, quiet).image.pixels, all.pixels) << samples;
    }
}

} // namespace
} // namespace patina
