// What a sphere on its own must show: depth, normal, coverage in closed form; the same in a file.

#include "render/exr_picture.h"
#include "render/features.h"
#include "render/path_tracer.h"

#include "base/errors.h"
#include "support/temporary_folder.h"
#include "test_scenes.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3f;

struct Sphere {
    SurfaceMesh mesh = sphereMesh(96, 1.f);
    RenderScene scene;
    Camera camera = Camera::aimed(V3f(0.f), 6.f, {}, 1.f);
    Progress progress;
    Sphere() {
        scene.surface = &mesh;
        scene.ground = false;
        scene.material = [](const SurfacePoint&, const V3f&) { return lambert(V3f(0.5f)); };
    }
    Features features(int samples = 16) {
        return renderFeatures(
            scene,
            [](const SurfacePoint&) {
                return PointFeatures{{0.2f, 0.3f, 0.4f}, 2, 7.5f};
            },
            camera, 64, 64, samples, 1, progress);
    }
};

TEST(Features, ofASphereAreItsOwn) {
    Sphere sphere;
    const Features features = sphere.features();
    EXPECT_NEAR(*features.depth.at(32, 32), 5.f, 0.01f);
    EXPECT_EQ(*features.material.at(32, 32), 2.f);
    EXPECT_NEAR(*features.thickness.at(32, 32), 7.5f, 1e-4f);
    EXPECT_NEAR((features.albedo.rgb(32, 32) - V3f(0.2f, 0.3f, 0.4f)).length(), 0.f, 1e-5f);
    EXPECT_GT(features.normal.rgb(32, 32) ^ (sphere.camera.position() / 6.f), 0.999f);
    EXPECT_TRUE(std::isinf(*features.depth.at(0, 0)));
    EXPECT_EQ(*features.material.at(0, 0), -1.f);
    // The silhouette is the cone of half-angle asin(1/6): a disc of known area in the picture.
    double covered = 0.0;
    for (const float a : features.alpha.pixels)
        covered += a;
    const double radius = std::tan(std::asin(1.0 / 6.0)) / std::tan(11.0 * M_PI / 180.0) * 32.0;
    EXPECT_NEAR(covered / (M_PI * radius * radius), 1.0, 0.01);
}

TEST(Features, areWrittenUnderTheNamesOfCompositing) {
    Sphere sphere;
    const test::TemporaryFolder folder;
    const Features features = sphere.features(4);
    const Image light(64, 64, 3, 0.25f);
    writeExrPicture(light, &features, folder.path() / "sphere.exr", {{"Software", "test"}});
    Imf::InputFile file((folder.path() / "sphere.exr").string().c_str());
    for (const char* name :
         {"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B", "material", "thickness"})
        EXPECT_NE(file.header().channels().findChannel(name), nullptr) << name;
    EXPECT_THROW(writeExrPicture(Image(32, 32), &features, folder.path() / "other.exr"), RunError);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "other.exr"));
}

TEST(Camera, aLensIsSharpWhereItIsFocusedAndBlursElsewhere) {
    Camera camera = Camera::aimed(V3f(0.f), 6.f, {}, 1.f);
    camera.setLens(0.2f, 6.f);
    const Imath::V2f spots[] = {{0.9f, 0.1f}, {0.3f, 0.6f}, {1.f, 0.8f}};
    const CameraRay middle = camera.ray(0.3f, 0.7f);
    const auto atDistance = [&](const CameraRay& ray, float distance) {
        return ray.origin + ray.direction * (distance / (ray.direction ^ camera.forward()));
    };
    for (const auto& spot : spots) {
        const CameraRay ray = camera.ray(0.3f, 0.7f, spot);
        EXPECT_NEAR((atDistance(ray, 6.f) - atDistance(middle, 6.f)).length(), 0.f, 0.25f);
    }
    const V3f a = atDistance(camera.ray(0.3f, 0.7f, spots[0]), 6.f),
              b = atDistance(camera.ray(0.3f, 0.7f, spots[1]), 6.f);
    EXPECT_NEAR((a - b).length(), 0.f, 1e-4f);
    const V3f c = atDistance(camera.ray(0.3f, 0.7f, spots[0]), 12.f),
              d = atDistance(camera.ray(0.3f, 0.7f, spots[1]), 12.f);
    EXPECT_GT((c - d).length(), 0.05f);
    EXPECT_THROW(camera.setLens(-1.f, 2.f), RunError);
    EXPECT_THROW(Camera::aimed(V3f(0.f), 0.f, {}, 1.f), RunError);
}

TEST(PathTracer, refusesACameraInsideTheObject) {
    Sphere sphere;
    const Lights lights(std::make_shared<UniformEnvironment>(V3f(1.f)));
    RenderOptions options;
    options.width = options.height = 8;
    options.samples = 1;
    EXPECT_THROW(render(sphere.scene, Camera::aimed(V3f(0.f), 0.5f, {}, 1.f), lights, options, sphere.progress),
                 RunError);
    EXPECT_NO_THROW(render(sphere.scene, Camera::aimed(V3f(0.f), 1.5f, {}, 1.f), lights, options, sphere.progress));
}

TEST(PathTracer, aPictureInSomeSecondsIsThatOfItsSamples) {
    Sphere sphere;
    const Lights lights = studioLights(UpAxis::z);
    RenderOptions options;
    options.width = options.height = 48;
    options.samples = 4096;
    options.seconds = 0.3;
    const Rendering timed = render(sphere.scene, sphere.camera, lights, options, sphere.progress);
    EXPECT_GE(timed.samples, 1);
    EXPECT_LT(timed.samples, 4096);
    options.seconds = 0.0;
    options.samples = timed.samples;
    EXPECT_EQ(render(sphere.scene, sphere.camera, lights, options, sphere.progress).image.pixels, timed.image.pixels);
}

} // namespace
} // namespace patina
