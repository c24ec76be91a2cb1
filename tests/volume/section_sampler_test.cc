#include "volume/section_sampler.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

constexpr double radius = 30.0, first = 0.4, second = 1.0;

std::unique_ptr<test::Piece> coatedSphere() {
    auto piece = test::makePiece(test::sphere(float(radius), 5), test::voxelScale());
    Workpiece work = piece->work();
    coat(work, "cuprite_2", first, nullptr, piece->progress);
    coat(work, "brochantite", second, nullptr, piece->progress);
    return piece;
}

TEST(SectionSampler, TellsMetalLayersAndAirApart) {
    const auto piece = coatedSphere();
    const SectionSampler sampler(*piece->volume);
    const Imath::V3d direction = Imath::V3d(1.0, 2.0, -0.5).normalized();
    EXPECT_EQ(sampler.regionAt(Imath::V3d(0.0)), 0);
    EXPECT_EQ(sampler.regionAt(direction * (radius - 0.1)), 0);
    EXPECT_EQ(sampler.regionAt(direction * (radius + 0.5 * first)), 1);
    EXPECT_EQ(sampler.regionAt(direction * (radius + first + 0.5 * second)), 2);
    EXPECT_EQ(sampler.regionAt(direction * (radius + first + second + 0.1)), SectionSampler::air);
    EXPECT_EQ(sampler.regionAt(direction * (3.0 * radius)), SectionSampler::air);
}

TEST(SectionSampler, FollowsAGreatCircle) {
    const auto piece = coatedSphere();
    const SectionSampler sampler(*piece->volume);
    const double step = 0.3;
    const int count = 401; // more than half the circle's length
    const Imath::V3d start = Imath::V3d(0.3, 0.2, 1.0).normalized() * radius, along(1.0, 0.0, 0.0);
    const auto feet = sampler.trace(start, along, step, count);
    const Imath::V3d plane = start.cross(along).normalized();
    for (int i = 0; i < count; ++i) {
        ASSERT_TRUE(feet[i]) << i;
        EXPECT_NEAR(feet[i]->position.length(), radius, 0.03);
        // The plane holds the level set's own normal at the start, which is half a degree off the sphere's.
        EXPECT_NEAR(feet[i]->position.dot(plane), 0.0, 0.01 * radius);
        const double angle = (i - count / 2) * step / radius;
        const Imath::V3d expected =
            (start.normalized() * std::cos(angle) + plane.cross(start.normalized()) * std::sin(angle)) * radius;
        EXPECT_LT((feet[i]->position - expected).length(), 0.01 * radius) << i;
        EXPECT_GT(feet[i]->normal.dot(feet[i]->position.normalized()), 0.999);
    }
}

TEST(SectionSampler, StopsWhereASheetEnds) {
    const auto piece = test::makePiece(test::sheet(40.f, 8), test::voxelScale());
    const SectionSampler sampler(*piece->volume);
    const auto feet = sampler.trace({5.0, 20.0, 0.0}, {1.0, 0.0, 0.0}, 0.5, 41);
    EXPECT_TRUE(feet[20]);
    EXPECT_TRUE(feet[40]);
    // The line goes on around the rim, but never into the air beyond it.
    for (const auto& foot : feet)
        if (foot) {
            EXPECT_GT(foot->position.x, -1.0);
        }
}

TEST(SectionSampler, SaysWhereThereIsNoMetal) {
    const auto piece = coatedSphere();
    const SectionSampler sampler(*piece->volume);
    EXPECT_THROW(sampler.trace({0.0, 0.0, 2.0 * radius}, {1.0, 0.0, 0.0}, 0.5, 11), RunError);
}

TEST(SectionSampler, TypicalPlaceLiesOnTheMetal) {
    const auto piece = coatedSphere();
    EXPECT_NEAR(SectionSampler(*piece->volume).typicalPlace().position.length(), radius, 0.03);
}

} // namespace
} // namespace patina
