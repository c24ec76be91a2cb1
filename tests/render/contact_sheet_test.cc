#include "render/contact_sheet.h"

#include "base/errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace patina {
namespace {

std::vector<LabelledImage> grey(int count, const std::string& label) {
    return std::vector<LabelledImage>(std::size_t(count), {Image(80, 60, 3, 0.5f), label});
}

TEST(ContactSheet, hasRoomForEveryPictureGapLabelAndTitle) {
    ContactSheetOptions options;
    options.columns = 3;
    options.gap = 10;
    options.labelHeight = 14;
    const Image plain = makeContactSheet(grey(6, ""), options).image;
    EXPECT_EQ(plain.width, 10 + 3 * 90);
    EXPECT_EQ(plain.height, 10 + 2 * 70);
    const Image labelled = makeContactSheet(grey(6, "a"), options).image;
    EXPECT_EQ(labelled.height, 10 + 2 * (70 + 28));
    options.title = "T";
    EXPECT_EQ(makeContactSheet(grey(6, "a"), options).image.height, 42 + 10 + 2 * (70 + 28));
}

TEST(ContactSheet, picturesAreCopiedUnchanged) {
    std::vector<LabelledImage> images = grey(2, "");
    images[1].image = Image(20, 10, 3, 0.25f);
    ContactSheetOptions options;
    options.columns = 2;
    options.gap = 4;
    const Image sheet = makeContactSheet(images, options).image;
    EXPECT_EQ(sheet.rgb(4, 4), Imath::V3f(0.5f));
    EXPECT_EQ(sheet.rgb(83, 63), Imath::V3f(0.5f));
    EXPECT_EQ(sheet.rgb(88 + 40, 4 + 30), Imath::V3f(0.25f)); // smaller ones stand in the middle of their cell
    EXPECT_EQ(sheet.rgb(88 + 5, 4 + 30), options.paper);
}

TEST(ContactSheet, choosesColumnsThatFillTheSheet) {
    const auto columns = [](int count) {
        ContactSheetOptions options;
        options.gap = 0;
        return makeContactSheet(grey(count, ""), options).image.width / 80;
    };
    EXPECT_EQ(columns(1), 1);
    EXPECT_EQ(columns(6), 3);
    EXPECT_EQ(columns(8), 4);
}

TEST(ContactSheet, labelsAreDrawnUnderTheirPictureWhereThereIsAFont) {
    ContactSheetOptions options;
    options.columns = 2;
    const ContactSheet sheet = makeContactSheet(grey(2, "12 years"), options);
    const auto inkIn = [&](int left, int right) {
        int ink = 0;
        for (int y = 12 + 60; y < sheet.image.height; ++y)
            for (int x = left; x < right; ++x)
                ink += sheet.image.at(x, y)[0] < 0.5f;
        return ink;
    };
    if (!sheet.hasText)
        GTEST_SKIP() << "no font is installed; labels were left out, as promised";
    EXPECT_GT(inkIn(12, 92), 40);
    EXPECT_GT(inkIn(104, 184), 40);
    EXPECT_EQ(inkIn(92, 104), 0);
    EXPECT_EQ(inkIn(0, 12), 0);
}

TEST(ContactSheet, longLabelsFitTheirCell) {
    for (const std::string words : {"a label that is a good deal wider than its cell",
                                    "one that is too wide for its cell even at half its height, as titles of drafts are, "
                                    "and has to end sooner than its writer did"}) {
        Image image(1400, 60, 3, 1.f);
        if (!drawText(image, words, 700.f, 40.f, 24, Imath::V3f(0.f), TextAlign::centre, 300.f))
            GTEST_SKIP() << "no font is installed";
        int left = image.width, right = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (image.at(x, y)[0] < 0.9f)
                    left = std::min(left, x), right = std::max(right, x);
        EXPECT_LE(right - left, 310);
        EXPECT_GT(right - left, 200);
        EXPECT_NEAR(0.5 * (left + right), 700.0, 8.0);
    }
}

// Down to half its height a label is drawn whole: as it is at one of these heights where nothing limits it.
TEST(ContactSheet, labelsLoseNoWordsWhileTheyCanShrink) {
    bool hasFont = false;
    const auto drawn = [&](int height, float widest) {
        Image image(900, 60, 3, 1.f);
        hasFont = drawText(image, "early: step 4 (white: 1.9 mm)", 450.f, 40.f, height, Imath::V3f(0.f),
                           TextAlign::centre, widest);
        return image.pixels;
    };
    std::vector<std::vector<float>> whole;
    for (int height = 12; height <= 24; ++height)
        whole.push_back(drawn(height, 0.f));
    if (!hasFont)
        GTEST_SKIP() << "no font is installed";
    for (float widest = 190.f; widest < 340.f; widest += 3.f)
        EXPECT_EQ(std::count(whole.begin(), whole.end(), drawn(24, widest)), 1) << widest;
}

// A µ is a u that goes on below the line, where its left stem is; and it shifts nothing else.
TEST(ContactSheet, aMicrometreIsNotAUm) {
    const auto drawn = [](const std::string& words, bool& hasFont) {
        Image image(300, 80, 3, 1.f);
        hasFont = drawText(image, words, 20.f, 50.f, 40, Imath::V3f(0.f));
        return image;
    };
    bool hasFont = false;
    const Image mu = drawn("12 µm", hasFont), u = drawn("12 um", hasFont);
    if (!hasFont)
        GTEST_SKIP() << "no font is installed";
    int below = 0, differing = 0, left = mu.width, right = 0, lastOfWord = 0;
    for (int y = 0; y < mu.height; ++y)
        for (int x = 0; x < mu.width; ++x) {
            if (u.at(x, y)[0] < 0.5f)
                lastOfWord = std::max(lastOfWord, x);
            if (std::abs(mu.at(x, y)[0] - u.at(x, y)[0]) < 0.25f)
                continue;
            ++differing;
            below += y >= 50;
            left = std::min(left, x), right = std::max(right, x);
        }
    EXPECT_GT(below, 12) << "a stem of several pixels";
    EXPECT_LE(differing - below, 6) << "above the line nothing changes but where the stem joins";
    EXPECT_LE(right - left, 8) << "one stem";
    EXPECT_GT(left, 60) << "behind the digits";
    EXPECT_LT(right, lastOfWord - 30) << "before the m";
}

TEST(ContactSheet, textOutsideThePictureIsLeftOut) {
    Image image(20, 20, 3, 1.f);
    for (const auto& [x, y] : {std::pair(5.f, 100.f), {5.f, -100.f}, {500.f, 10.f}, {-500.f, 10.f}})
        drawText(image, "12 \u00b5m", x, y, 12, Imath::V3f(0.f));
    for (const float value : image.pixels)
        ASSERT_EQ(value, 1.f);
}

TEST(ContactSheet, refusesNoPicturesAndBrokenOnes) {
    EXPECT_THROW(makeContactSheet({}), RunError);
    EXPECT_THROW(makeContactSheet({{Image(), "a"}}), RunError);
    EXPECT_THROW(makeContactSheet({{Image(4, 4, 1), "a"}}), RunError);
}

} // namespace
} // namespace patina
