#include "render/film.h"

#include "base/atomic_file.h"
#include "base/errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace patina {
namespace {

class FilmFiles : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() / (std::string("patina_film_") + info->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

Image ramp() {
    Image image(64, 5);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            image.setRgb(x, y, {float(x) / 63.f, float(y) / 4.f, 0.25f});
    return image;
}

TEST_F(FilmFiles, pngComesBackToHalfAStepOfEightBits) {
    const Image image = ramp();
    writePng(image, folder_ / "a.png");
    const Image back = readPng(folder_ / "a.png");
    ASSERT_EQ(back.width, image.width);
    ASSERT_EQ(back.height, image.height);
    ASSERT_EQ(back.channels, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        ASSERT_NEAR(back.pixels[i], image.pixels[i], 0.5f / 255.f + 1e-6f);
}

TEST_F(FilmFiles, pngCarriesItsProvenanceAndNoTime) {
    const ImageMetadata words = {{"Software", "vdb-patina 1"}, {"patina_seed", "7"}, {"patina_script", "new copper;"}};
    writePng(ramp(), folder_ / "a.png", words);
    writePng(ramp(), folder_ / "b.png", words);
    EXPECT_EQ(readTextFile(folder_ / "a.png"), readTextFile(folder_ / "b.png"));
    ImageMetadata back;
    readPng(folder_ / "a.png", &back);
    for (const auto& [name, text] : words)
        EXPECT_EQ(back[name], text) << name;
    EXPECT_EQ(back.count("DateTime"), 0u);
}

TEST_F(FilmFiles, nothingHalfWrittenIsLeftBehind) {
    EXPECT_THROW(writePng(Image(), folder_ / "a.png"), RunError);
    EXPECT_THROW(writePng(ramp(), folder_ / "a.unknown"), RunError);
    EXPECT_THROW(writePng(ramp(), folder_ / "missing" / "a.png"), RunError);
    EXPECT_THROW(readPng(folder_ / "none.png"), RunError);
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST(ViewTransform, srgbIsTheStandardCurve) {
    Image linear(5, 1);
    const float in[5] = {0.f, 0.0031308f, 0.2140411f, 1.f, 7.f};
    const float out[5] = {0.f, 0.04045f, 0.5f, 1.f, 1.f}; // IEC 61966-2-1
    for (int x = 0; x < 5; ++x)
        linear.setRgb(x, 0, Imath::V3f(in[x]));
    const Image shown = displayImage(linear, {ViewTransform::srgb, 0.f, false});
    for (int x = 0; x < 5; ++x)
        EXPECT_NEAR(shown.rgb(x, 0).y, out[x], 1e-5f);
}

TEST(ViewTransform, exposureDoublesLightAStop) {
    Image one(1, 1, 3, 0.1f), two(1, 1, 3, 0.4f);
    EXPECT_NEAR(displayImage(one, {ViewTransform::srgb, 2.f, false}).pixels[0],
                displayImage(two, {ViewTransform::srgb, 0.f, false}).pixels[0], 1e-6f);
}

TEST(ViewTransform, filmicKeepsColoursBelowItsKneeAndNeverClips) {
    float last = -1.f;
    for (float light = 0.f; light < 3.f; light += 0.01f) {
        const float shown = filmicShoulder(light);
        EXPECT_GT(shown, last);
        EXPECT_LT(shown, 1.f);
        if (light <= 0.6f) {
            EXPECT_EQ(shown, light);
        }
        last = shown;
    }
    EXPECT_NEAR((filmicShoulder(0.601f) - 0.6f) / 0.001f, 1.f, 0.01f); // no kink
}

TEST(ViewTransform, ditherMovesNoValueByMoreThanHalfAStep) {
    const Image plain = displayImage(Image(32, 32, 3, 0.18f), {ViewTransform::srgb, 0.f, false});
    const Image dithered = displayImage(Image(32, 32, 3, 0.18f), {ViewTransform::srgb, 0.f, true});
    double mean = 0.0;
    for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
        EXPECT_LE(std::abs(dithered.pixels[i] - plain.pixels[i]), 0.5f / 255.f + 1e-6f);
        mean += double(dithered.pixels[i] - plain.pixels[i]) / double(plain.pixels.size());
    }
    EXPECT_LT(std::abs(mean), 0.02 / 255.0);
}

TEST(ViewTransform, whatIsNotFiniteBecomesBlack) {
    Image bad(1, 1);
    bad.setRgb(0, 0, {NAN, INFINITY, -1.f});
    for (const float v : displayImage(bad).pixels)
        EXPECT_EQ(v, 0.f);
}

TEST(Film, anyPictureBecomesRgbOverWhite) {
    Image grey(1, 1, 1, 0.25f);
    EXPECT_EQ(asRgb(grey).rgb(0, 0), Imath::V3f(0.25f));
    Image glass(1, 1, 4);
    const float half[] = {0.5f, 0.f, 1.f, 0.5f};
    std::copy(half, half + 4, glass.at(0, 0));
    EXPECT_EQ(asRgb(glass).rgb(0, 0), Imath::V3f(0.75f, 0.5f, 1.f));
}

} // namespace
} // namespace patina
