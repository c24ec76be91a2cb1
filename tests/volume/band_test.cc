#include "volume/band.h"

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Band, GrowsWithoutTouchingWhatIsThere) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    piece->volume->pushLayer("soot");
    const auto before = piece->volume->grids().base->deepCopy();
    ASSERT_TRUE(ensureExteriorBand(*piece->volume, 9.0));
    const NestGrids& grids = piece->volume->grids();
    EXPECT_GE(grids.exteriorBand, 9.0);
    for (auto voxel = before->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(grids.base->tree().getValue(voxel.getCoord()), *voxel);
    EXPECT_TRUE(grids.base->tree().hasSameTopology(grids.interfaces[0]->tree()));
    EXPECT_TRUE(grids.base->tree().hasSameTopology(grids.material->tree()));
    // The new shell carries the distance outward.
    EXPECT_NEAR(grids.base->tree().getValue(grids.space.index(28, 0, 0)), 8.0, 0.01);
}

TEST(Band, GrowsAboveTheSurfaceOnlyWhereItHasTo) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    // A bump of two voxels around the north pole.
    piece->volume->pushLayer("soot");
    for (FloatLeaf* leaf : leavesOf(piece->volume->grids().surface().tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            if (piece->volume->grids().space.place(voxel.getCoord()).z > 15)
                voxel.setValue(*voxel - 2.f);
    const NestGrids& grids = piece->volume->grids();
    EXPECT_FALSE(ensureBandAbove(*piece->volume, 1.5));
    ASSERT_TRUE(ensureBandAbove(*piece->volume, 3.5));
    EXPECT_TRUE(grids.base->tree().isValueOn(grids.space.index(0, 0, 25)));
    EXPECT_FALSE(grids.base->tree().isValueOn(grids.space.index(0, 0, -25)));
    EXPECT_NEAR(grids.base->tree().getValue(grids.space.index(0, 0, 25)), 5.0, 0.02);
    EXPECT_NEAR(grids.surface().tree().getValue(grids.space.index(0, 0, 25)), 3.0, 0.05);
    EXPECT_TRUE(grids.base->tree().hasSameTopology(grids.interfaces[0]->tree()));
    EXPECT_TRUE(grids.base->tree().hasSameTopology(grids.material->tree()));
}

TEST(Band, StaysAsItIsWhereItIsWideEnough) {
    const auto piece = test::makePiece(test::sphere(20.f, 3), test::voxelScale());
    const std::string before = contentHash(*piece->volume);
    EXPECT_FALSE(ensureExteriorBand(*piece->volume, 3.0));
    EXPECT_EQ(contentHash(*piece->volume), before);
}

TEST(Band, StackHeightIsTheHighestInterface) {
    const auto piece = test::makePiece(test::sphere(20.f, 3), test::voxelScale());
    EXPECT_EQ(stackHeightVoxels(*piece->volume), 0.0);
    piece->volume->pushLayer("soot");
    for (FloatLeaf* leaf : leavesOf(piece->volume->grids().surface().tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            voxel.setValue(*voxel - 0.75f);
    EXPECT_NEAR(stackHeightVoxels(*piece->volume), 0.75, 1e-6);
}

} // namespace
} // namespace patina
