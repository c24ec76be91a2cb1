#include "render/turntable.h"

#include "render/stage.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <limits>

namespace patina {
namespace {

using Imath::V3f;

constexpr float infinite = std::numeric_limits<float>::infinity();

TEST(Turntable, IsMetOnItsTopAndOnItsSide) {
    const Turntable table({1, 0, 2}, {0, 0, 1}, 3.f, 0.5f);
    const auto top = table.intersect({0, 0, 5}, {0, 0, -1}, 100.f);
    ASSERT_TRUE(top);
    EXPECT_FLOAT_EQ(top->distance, 3.f);
    EXPECT_EQ(top->normal, V3f(0, 0, 1));
    const auto side = table.intersect({11, 0, 1.75f}, {-1, 0, 0}, 100.f);
    ASSERT_TRUE(side);
    EXPECT_NEAR(side->distance, 7.f, 1e-5f);
    EXPECT_NEAR((side->normal - V3f(1, 0, 0)).length(), 0.f, 1e-5f);
    EXPECT_FALSE(table.intersect({11, 0, 1.75f}, {-1, 0, 0}, 6.9f)) << "further than asked for";
    EXPECT_FALSE(table.intersect({11, 0, 2.1f}, {-1, 0, 0}, 100.f)) << "above its top";
    EXPECT_FALSE(table.intersect({11, 0, 1.4f}, {-1, 0, 0}, 100.f)) << "below its bottom";
    EXPECT_FALSE(table.intersect({5, 0, 5}, {0, 0, -1}, 100.f)) << "beside it";
    EXPECT_FALSE(table.intersect({0, 0, 2.1f}, {0, 0, 1}, 100.f)) << "away from it";
}

// The table is under the object, the floor around lower by its thickness; it shades the floor beside it.
TEST(Turntable, StandsOnTheFloorOfTheStage) {
    const SurfaceMesh ball = sphereMesh(12, 1.f);
    RenderScene scene;
    scene.surface = &ball;
    scene.turntable = true;
    const Stage stage(scene);
    StagePoint point = stage.floorPoint({1.2f, 0, 3}, {0, 0, -1});
    const float table = point.position.z;
    EXPECT_NEAR(table, -1.f, 0.01f);
    point = stage.floorPoint({3.f, 0, 3}, {0, 0, -1});
    EXPECT_LT(point.position.z, table - 0.03f);
    // From the floor beside the table, light that comes low across it is blocked; from above it is not.
    point = stage.floorPoint({1.7f, 0, 3}, {0, 0, -1});
    EXPECT_TRUE(stage.setBlocks(point.origin, V3f(-1.f, 0.f, 0.02f).normalized(), infinite));
    EXPECT_FALSE(stage.setBlocks(point.origin, {0, 0, 1}, infinite));
    EXPECT_FALSE(stage.setBlocks(point.origin, V3f(-1.f, 0.f, 0.02f).normalized(), 0.05f)) << "a light nearer than the table";
}

} // namespace
} // namespace patina
