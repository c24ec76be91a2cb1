// Panoramas and skies: where their light comes from and how much of it arrives.

#include "render/image_environment.h"
#include "render/sky_environment.h"

#include "base/errors.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3f;

Image panorama(int height, const V3f& light) {
    Image image(2 * height, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < image.width; ++x)
            image.setRgb(x, y, light);
    return image;
}

TEST(ImageEnvironment, theMiddleOfAPanoramaLiesAheadOfTheViewerAndItsRightToTheRight) {
    Image image = panorama(32, V3f(0.f));
    image.setRgb(32, 16, {1, 0, 0}); // ahead
    image.setRgb(48, 16, {0, 1, 0}); // right
    image.setRgb(31, 0, {0, 0, 1});  // up
    for (int x = 0; x < 64; ++x)
        image.setRgb(x, 0, {0, 0, 1});
    for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
        const Frame set = uprightFrame(up);
        const ImageEnvironment light(image, up);
        EXPECT_GT(light.radiance((set.bitangent - 0.05f * set.normal).normalized()).x, 0.2f);
        EXPECT_GT(light.radiance((set.tangent - 0.05f * set.normal).normalized()).y, 0.2f);
        EXPECT_EQ(light.radiance(set.normal), V3f(0, 0, 1));
        // A quarter turn counter-clockwise takes what lay ahead to the left.
        const ImageEnvironment turned(image, up, 90.f);
        EXPECT_GT(turned.radiance((-set.tangent - 0.05f * set.normal).normalized()).x, 0.2f);
    }
}

TEST(ImageEnvironment, ASmallSunIsFoundBySampling) {
    // One pixel of 512 x 256: half a degree of radiance 10,000.
    Image image = panorama(256, V3f(0.1f));
    image.setRgb(150, 60, V3f(1e4f));
    const Lights lights(std::make_shared<ImageEnvironment>(image, UpAxis::z));
    double exact = 0.0, estimate = 0.0;
    constexpr int n = 20000;
    for (int y = 0; y < 128; ++y) { // above the horizon
        const double theta = M_PI * (y + 0.5) / 256;
        for (int x = 0; x < 512; ++x)
            exact += image.rgb(x, y).x * std::cos(theta) * std::sin(theta) * (M_PI / 256) * (M_PI / 256);
    }
    for (int i = 0; i < n; ++i) {
        const Imath::V2f u(float(std::fmod(0.5 + i * 0.7548776662466927, 1.0)),
                           float(std::fmod(0.5 + i * 0.5698402909980532, 1.0)));
        const auto sample = lights.sample(Lights::environment, V3f(0, 0, 1), u);
        if (sample.pdf > 0.f)
            estimate += sample.radiance.x * std::max(0.f, sample.direction.z) / sample.pdf / n;
    }
    EXPECT_NEAR(estimate / exact, 1.0, 0.03);
}

TEST(ImageEnvironment, refusesWhatIsNoPanorama) {
    EXPECT_THROW(ImageEnvironment(Image(64, 48), UpAxis::z), RunError);
    Image broken = panorama(16, V3f(1.f));
    broken.setRgb(3, 4, V3f(std::nanf("")));
    EXPECT_THROW(ImageEnvironment(broken, UpAxis::z), RunError);
    broken.setRgb(3, 4, V3f(-1.f));
    EXPECT_THROW(ImageEnvironment(broken, UpAxis::z), RunError);
    EXPECT_THROW(readPanorama("no_such.exr"), RunError);
}

TEST(Daylight, aCardOnTheGroundReceivesPiUnderEverySky) {
    for (const int sky : {1, 5, 12, 16})
        for (const float altitude : {15.f, 40.f, 75.f}) {
            Daylight day;
            day.sky = sky;
            day.sun = sky == 12;
            day.sunAltitudeDegrees = altitude;
            const Lights lights = daylight(day, UpAxis::y);
            EXPECT_NEAR(lights.irradiance(V3f(0, 1, 0)).x, M_PI, 0.1) << sky << " at " << altitude;
        }
}

TEST(Daylight, theSunShinesFromWhereItStands) {
    Daylight day;
    day.sunAzimuthDegrees = 90.f; // to the right of a viewer in front
    day.sunAltitudeDegrees = 30.f;
    const Lights lights = daylight(day, UpAxis::z);
    const float radians = float(M_PI) / 180.f;
    EXPECT_GT(lights.radiance(Lights::keyLight, {std::cos(30.f * radians), 0, std::sin(30.f * radians)}).x, 1e3f);
    EXPECT_EQ(lights.radiance(Lights::keyLight, {-1, 0, 0}).x, 0.f);
    day.sunAltitudeDegrees = 100.f;
    EXPECT_THROW(daylight(day, UpAxis::z), RunError);
    day.sunAltitudeDegrees = -3.f; // dusk: the sky alone
    EXPECT_EQ(daylight(day, UpAxis::z).chance(Lights::keyLight), 0.f);
}

} // namespace
} // namespace patina
