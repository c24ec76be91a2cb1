#include "volume/material_ids.h"

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

int idAt(const LayerVolume& volume, int x, int y, int z) {
    return volume.grids().material->tree().getValue(volume.grids().space.index(x, y, z));
}

// A sheet at z = 0 with a layer up to z = t (voxels = µm).
std::unique_ptr<test::Piece> coatedSheet(float t) {
    auto piece = test::makePiece(test::sheet(20.f, 10), test::voxelScale());
    piece->volume->pushLayer("soot");
    for (FloatLeaf* leaf : leavesOf(piece->volume->grids().surface().tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            voxel.setValue(*voxel - t);
    updateMaterialIds(*piece->volume);
    return piece;
}

TEST(MaterialIds, BareMetalIsOneAndAirIsZero) {
    const auto piece = test::makePiece(test::sheet(20.f, 10), test::voxelScale());
    EXPECT_EQ(idAt(*piece->volume, 10, 10, -2), 1);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 2), 0);
    EXPECT_EQ(piece->volume->palette(), (std::vector<std::string>{"air", "copper"}));
}

TEST(MaterialIds, AVoxelHasItsOutermostMaterial) {
    const auto piece = coatedSheet(2.f);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, -1), 1);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 1), 2);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 2), 2); // its lower half is soot
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 3), 0);
}

TEST(MaterialIds, AFilmThinnerThanAVoxelShowsInItsVoxel) {
    const auto piece = coatedSheet(0.01f); // ten nanometres
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 0), 2);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, -1), 1);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 1), 0);
}

TEST(MaterialIds, LessThanANanometreIsNotPresent) {
    const auto piece = coatedSheet(0.0005f);
    EXPECT_EQ(idAt(*piece->volume, 10, 10, 0), 1);
}

TEST(MaterialIds, OnlyChangedVoxelsAreTouched) {
    const auto piece = coatedSheet(2.f);
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

} // namespace
} // namespace patina
