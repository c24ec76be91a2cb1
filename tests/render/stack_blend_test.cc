#include "render/stack_blend.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Names = std::vector<std::string>;

TEST(CommonOrder, HoldsBothHistories) {
    EXPECT_EQ(commonOrder({}, {}), Names{});
    EXPECT_EQ(commonOrder({"a"}, {"a", "b"}), (Names{"a", "b"}));
    EXPECT_EQ(commonOrder({"a", "soot"}, {"a", "b", "soot"}), (Names{"a", "b", "soot"}));
    EXPECT_EQ(commonOrder({"a", "x", "b"}, {"a", "b"}), (Names{"a", "x", "b"})) << "one that is gone keeps its place";
    EXPECT_EQ(commonOrder({"a", "b", "a"}, {"a", "b", "a", "c"}), (Names{"a", "b", "a", "c"}));
}

std::unique_ptr<test::Piece> coated(const std::vector<std::pair<std::string, double>>& layers) {
    auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    Workpiece work = piece->work();
    for (const auto& [material, um] : layers)
        coat(work, material, um, nullptr, piece->progress);
    return piece;
}

TEST(StackBlend, ThicknessesAndHeightsLieOnAStraightLine) {
    const auto before = coated({{"cuprite", 0.4}}), after = coated({{"cuprite", 0.8}, {"brochantite", 2.0}});
    const StackBlend blend(*before->volume, *after->volume, before->surface);
    ASSERT_EQ(blend.layers(), (Names{"cuprite", "brochantite"}));
    for (const float share : {0.f, 0.25f, 1.f}) {
        const std::vector<float> heights = blend.vertexHeights(share);
        for (int triangle = 0; triangle < int(before->surface.triangles.size()); triangle += 97) {
            float um[2];
            blend.thickness({triangle, 0.3f, 0.3f}, share, um);
            EXPECT_NEAR(um[0], 0.4f + 0.4f * share, 0.01f);
            EXPECT_NEAR(um[1], 2.f * share, 0.02f);
            const int vertex = before->surface.triangles[std::size_t(triangle)].x;
            EXPECT_NEAR(heights[std::size_t(vertex)], 0.4f + 2.4f * share, 0.03f);
        }
    }
}

TEST(StackBlend, RefusesWhatAreNotTwoMomentsOfOneThing) {
    const auto one = coated({});
    VolumeScale other = test::voxelScale();
    other.exaggeration = 2.0;
    const auto larger = test::makePiece(test::sphere(20.f, 4), other);
    EXPECT_THROW(StackBlend(*one->volume, *larger->volume, one->surface), RunError);
}

} // namespace
} // namespace patina
