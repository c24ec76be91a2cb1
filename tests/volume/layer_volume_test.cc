#include "volume/layer_volume.h"

#include "support/test_surfaces.h"
#include "volume/layer_statistics.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(LayerVolume, NamesItsGridsFromTheBottomUp) {
    const auto piece = test::makePiece(test::sphere(10.f, 3), test::voxelScale());
    piece->volume->pushLayer("tarnish_1");
    piece->volume->pushLayer("cuprite_2");
    EXPECT_EQ(piece->volume->interfaceGridName(1), "interface_01_tarnish_1");
    EXPECT_EQ(piece->volume->interfaceGridName(2), "interface_02_cuprite_2");
    piece->volume->removeLayer(1);
    EXPECT_EQ(piece->volume->layers(), (std::vector<std::string>{"cuprite_2"}));
}

TEST(LayerVolume, AMaterialKeepsItsId) {
    const auto piece = test::makePiece(test::sphere(10.f, 3), test::voxelScale());
    const auto id = piece->volume->materialId("soot");
    EXPECT_EQ(piece->volume->materialId("dirt"), id + 1);
    EXPECT_EQ(piece->volume->materialId("soot"), id);
    EXPECT_EQ(piece->volume->findMaterialId("gold"), 0);
}

TEST(LayerVolume, ACloneIsEqualAndItsOwn) {
    const auto piece = test::makePiece(test::sphere(10.f, 3), test::voxelScale());
    piece->volume->pushLayer("soot");
    LayerVolume copy = piece->volume->clone();
    EXPECT_EQ(contentHash(copy), contentHash(*piece->volume));
    leavesOf(copy.grids().surface().tree())[0]->fill(1.f, true);
    EXPECT_NE(contentHash(copy), contentHash(*piece->volume));
}

TEST(LayerStatistics, ASphereOfKnownAreaAndFilm) {
    const auto piece = test::makePiece(test::sphere(40.f, 5), test::voxelScale());
    piece->volume->pushLayer("soot");
    for (FloatLeaf* leaf : leavesOf(piece->volume->grids().surface().tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            voxel.setValue(*voxel - 0.2f);
    const StackStatistics stack = measureStack(*piece->volume, piece->surface);
    EXPECT_NEAR(stack.areaM2, 4.0 * M_PI * 1600.0 * 1e-12, 0.002 * stack.areaM2);
    EXPECT_NEAR(stack.layers[0].meanUm, 0.2, 0.001);
    EXPECT_NEAR(stack.layers[0].volumeM3, 0.2e-6 * stack.areaM2, 0.005 * stack.layers[0].volumeM3);
    EXPECT_NEAR(stack.layers[0].coverage, 1.0, 1e-9);
    EXPECT_LT(stack.voxelizationErrorVoxels, 0.02);
    EXPECT_EQ(stack.unreadable, 0.0);
}

} // namespace
} // namespace patina
