#include "export/outer_surface.h"

#include "export/bake.h"
#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

// A sheet of 40 voxels under 5 voxels of cuprite; beyond x = 20 air from z = 1 to 3 lies under a roof.
class OuterSurfaceTest : public testing::Test {
  protected:
    void SetUp() override {
        piece_ = test::makePiece(test::sheet(40.f, 40), test::voxelScale(), 10.0);
        auto work = piece_->work();
        coat(work, "cuprite_2", 5.0, nullptr, piece_->progress);
    }
    void hollow() {
        for (auto voxel = piece_->volume->grids().interfaces[0]->beginValueOn(); voxel; ++voxel) {
            const Imath::V3i at = piece_->volume->grids().space.place(voxel.getCoord());
            const float inGap = std::min({float(at.x) - 20.f, float(at.z) - 1.f, 3.f - float(at.z)});
            voxel.setValue(std::max(*voxel, inGap));
        }
    }
    MapSet bakeAll() const {
        const MaterialLibrary library = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
        BakeOptions options;
        options.resolution = 64;
        options.foldMask = options.vectorDisplacement = options.fields = true;
        Progress progress;
        return bake(*piece_->volume, piece_->surface, StackOptics({&library.at("copper"), &library.at("cuprite_2")}),
                    options, progress);
    }
    std::unique_ptr<test::Piece> piece_;
};

constexpr int row = 32 * 64, solid = row + 16, underRoof = row + 48; // x = 10 and 30

TEST_F(OuterSurfaceTest, AnEvenLayerFoldsNowhere) {
    const MapSet maps = bakeAll();
    EXPECT_EQ(maps.summary.foldFraction, 0.0);
    for (const int at : {solid, underRoof})
        EXPECT_NEAR(maps.find("vector_displacement")->floats[at * 3 + 2], 5.f, 0.02f);
}

TEST_F(OuterSurfaceTest, TheMaskMarksWhatLiesUnderARoof) {
    hollow();
    const MapSet maps = bakeAll();
    const auto& mask = maps.find("fold_mask")->halves;
    EXPECT_EQ(float(mask[solid]), 0.f);
    EXPECT_EQ(float(mask[underRoof]), 1.f);
    // Half of the sheet; the outermost texels lie on its rim.
    EXPECT_NEAR(maps.summary.foldFraction, 0.5, 0.05);
}

TEST_F(OuterSurfaceTest, VectorsEndOnTheInterfaceThatBelongsToTheirPlace) {
    hollow();
    const OuterSurface outer(*piece_->volume);
    const auto solidEnd = outer.above({10, 20, 0}), underEnd = outer.above({30, 20, 0});
    ASSERT_TRUE(solidEnd && underEnd);
    EXPECT_NEAR(solidEnd->z, 5.0, 0.05);
    EXPECT_NEAR(underEnd->z, 1.0, 0.05); // the film on the metal, not the roof over it
}

TEST_F(OuterSurfaceTest, FieldsOfTheVolumeBecomeMaps) {
    auto& grids = piece_->volume->grids();
    grids.fields["exposure"] = makeGridLike(*grids.base, 0.25f);
    const MapSet maps = bakeAll();
    ASSERT_NE(maps.find("field_exposure"), nullptr);
    EXPECT_EQ(float(maps.find("field_exposure")->halves[solid]), 0.25f);
}

} // namespace
} // namespace patina
