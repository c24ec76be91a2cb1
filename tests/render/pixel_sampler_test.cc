#include "render/pixel_sampler.h"

#include <gtest/gtest.h>

#include <set>

namespace patina {
namespace {

// A Sobol' (0, 2)-sequence under Owen's scrambling keeps its net: of 2^m points, each elementary interval of area 2^-m
// holds exactly one.
TEST(PixelSampler, sixteenSamplesFillEveryElementaryInterval) {
    const KeyedRandom random(3, "picture", "test");
    for (int pixel = 0; pixel < 50; ++pixel) {
        PixelSampler sampler(random, pixel, 7);
        std::set<int> cells[5];
        for (std::uint32_t s = 0; s < 16; ++s) {
            sampler.startSample(s);
            sampler.next2();
            const Imath::V2f p = sampler.next2();
            ASSERT_GE(p.x, 0.f);
            ASSERT_LT(p.x, 1.f);
            for (int split = 0; split <= 4; ++split)
                cells[split].insert(int(p.x * float(1 << split)) * 16 + int(p.y * float(1 << (4 - split))));
        }
        for (const auto& hit : cells)
            EXPECT_EQ(hit.size(), 16u);
    }
}

TEST(PixelSampler, theTwoPointsOfEightSamplesFillThemToo) {
    const KeyedRandom random(3, "picture", "test");
    for (int pixel = 0; pixel < 50; ++pixel) {
        PixelSampler sampler(random, pixel, 7);
        std::set<int> cells[5];
        for (std::uint32_t s = 0; s < 8; ++s) {
            sampler.startSample(s);
            for (int part = 0; part < 2; ++part) {
                sampler.seek(3);
                const Imath::V2f p = sampler.next2(part, 2);
                for (int split = 0; split <= 4; ++split)
                    cells[split].insert(int(p.x * float(1 << split)) * 16 + int(p.y * float(1 << (4 - split))));
            }
        }
        for (const auto& hit : cells)
            EXPECT_EQ(hit.size(), 16u);
    }
}

TEST(PixelSampler, pixelsAndDrawsAreIndependent) {
    const KeyedRandom random(3, "picture", "test");
    double mean = 0.0, acrossPixels = 0.0, acrossDraws = 0.0;
    constexpr int count = 4000;
    for (int pixel = 0; pixel < count; ++pixel) {
        PixelSampler here(random, pixel, 0), beside(random, pixel, 1);
        const double a = double(here.next2().x) - 0.5, b = double(here.next2().x) - 0.5;
        const double c = double(beside.next2().x) - 0.5;
        mean += a / count, acrossDraws += a * b / count, acrossPixels += a * c / count;
    }
    // Standard errors: sqrt(1/12 / 4000) = 0.0046 and 1/12 / sqrt(4000) = 0.0013; five of each.
    EXPECT_NEAR(mean, 0.0, 0.023);
    EXPECT_NEAR(acrossDraws, 0.0, 0.0066);
    EXPECT_NEAR(acrossPixels, 0.0, 0.0066);
}

TEST(PixelSampler, aDrawDependsOnlyOnPixelSampleAndNumber) {
    const KeyedRandom random(9, "picture", "test");
    PixelSampler inOrder(random, 4, 5), outOfOrder(random, 4, 5);
    inOrder.startSample(6);
    for (int i = 0; i < 3; ++i)
        inOrder.next2();
    const Imath::V2f fourth = inOrder.next2();
    outOfOrder.startSample(2);
    outOfOrder.next2();
    outOfOrder.startSample(6);
    outOfOrder.seek(3);
    EXPECT_EQ(outOfOrder.next2(), fourth);
}

} // namespace
} // namespace patina
