// What other programs get of a volume: fog, half precision, level sets as they expect them.

#include "volume/fog_file.h"

#include "base/errors.h"
#include "support/coated_ball.h"
#include "support/temporary_folder.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

class FogFileTest : public testing::Test {
  protected:
    void SetUp() override { piece_ = test::coatedBall(); }
    openvdb::FloatGrid::Ptr gridOf(const std::string& file, const std::string& name) const {
        openvdb::io::File vdb((folder_ / file).string());
        vdb.open();
        auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(vdb.readGrid(name));
        vdb.close();
        return grid;
    }

    test::TemporaryFolder folder_;
    std::unique_ptr<test::Piece> piece_;
};

double sumOf(const openvdb::FloatGrid& grid) {
    double sum = 0.0;
    for (auto value = grid.cbeginValueOn(); value; ++value)
        sum += *value;
    return sum;
}

// The shells between the radii 15, 15.35 and 16.85 hold 4/3 π (b³ - a³).
TEST_F(FogFileTest, DensitiesAddUpToTheVolumeOfTheShells) {
    writeFog(*piece_->volume, folder_ / "fog.vdb", false);
    const double radii[] = {15.0, 15.35, 16.85};
    double all = 0.0;
    for (int k = 1; k <= 2; ++k) {
        const double volume = 4.0 / 3.0 * M_PI * (std::pow(radii[k], 3.0) - std::pow(radii[k - 1], 3.0));
        const auto grid = gridOf("fog.vdb", k == 1 ? "density_01_tarnish_1" : "density_02_soot");
        EXPECT_NEAR(sumOf(*grid) / volume, 1.0, 0.01) << k;
        all += sumOf(*grid);
    }
    EXPECT_NEAR(sumOf(*gridOf("fog.vdb", "density")) / all, 1.0, 1e-5);
}

TEST_F(FogFileTest, FogIsWhatShadersExpect) {
    writeFog(*piece_->volume, folder_ / "fog.vdb", false);
    const auto grid = gridOf("fog.vdb", "density");
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
    EXPECT_EQ(grid->background(), 0.f);
    EXPECT_EQ(grid->transform(), piece_->volume->grids().base->transform());
    for (auto value = grid->cbeginValueOn(); value; ++value) {
        EXPECT_GT(*value, 0.f);
        EXPECT_LE(*value, 1.f);
    }
    EXPECT_EQ(grid->tree().getValue(piece_->volume->grids().space.index(0, 0, 0)), 0.f);
    EXPECT_LT(grid->activeVoxelCount(), piece_->volume->activeVoxels());
}

TEST_F(FogFileTest, HalfPrecisionIsThreeDigits) {
    writeFog(*piece_->volume, folder_ / "single.vdb", false);
    writeFog(*piece_->volume, folder_ / "half.vdb", true);
    EXPECT_LT(std::filesystem::file_size(folder_ / "half.vdb"),
              0.9 * std::filesystem::file_size(folder_ / "single.vdb"));
    const auto single = gridOf("single.vdb", "density"), half = gridOf("half.vdb", "density");
    for (auto value = single->cbeginValueOn(); value; ++value)
        EXPECT_NEAR(half->tree().getValue(value.getCoord()), *value, 6e-4 * *value + 1e-7);
}

TEST_F(FogFileTest, AVolumeWithoutLayersIsNoFog) {
    const auto bare = test::makePiece(test::sphere(15.f, 3), test::voxelScale());
    EXPECT_THROW(writeFog(*bare->volume, folder_ / "fog.vdb", false), RunError);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "fog.vdb"));
}

// Fields may be half; a film of a thousandth of a voxel may not: level sets stay single.
TEST_F(FogFileTest, OnlyFieldsBecomeHalf) {
    auto& fields = piece_->volume->grids().fields;
    fields["exposure"] = makeGridLike(*piece_->volume->grids().base, 0.123456789f);
    writeVolume(*piece_->volume, folder_ / "single.vdb");
    VolumeFileOptions options;
    options.halfFields = true;
    writeVolume(*piece_->volume, folder_ / "half.vdb", options);
    const LayerVolume single = readVolume(folder_ / "single.vdb"), half = readVolume(folder_ / "half.vdb");
    const IndexSpace& space = piece_->volume->grids().space;
    const openvdb::Coord at = space.index(15, 0, 0);
    EXPECT_EQ(single.grids().fields.at("exposure")->tree().getValue(at), 0.123456789f);
    EXPECT_NE(half.grids().fields.at("exposure")->tree().getValue(at), 0.123456789f);
    EXPECT_NEAR(half.grids().fields.at("exposure")->tree().getValue(at), 0.123456789f, 1e-4);
    for (int i = 10; i < 20; ++i)
        EXPECT_EQ(half.grids().surface().tree().getValue(space.index(i, 0, 0)),
                  single.grids().surface().tree().getValue(space.index(i, 0, 0)));
}

// Programs tell inside from outside of a level set by the sign of what lies beyond its band.
TEST_F(FogFileTest, LevelSetsAreNegativeInsidePositiveOutsideAndHaveTheirClass) {
    writeVolume(*piece_->volume, folder_ / "a.vdb");
    for (const char* name : {"base", "surface", "interface_01_tarnish_1", "interface_02_soot"}) {
        const auto grid = gridOf("a.vdb", name);
        EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET) << name;
        EXPECT_GT(grid->background(), 0.f) << name;
        // The band reaches less far in than out.
        EXPECT_EQ(grid->tree().getValue(piece_->volume->grids().space.index(0, 0, 0)), static_cast<float>(-piece_->volume->grids().interiorBand)) << name;
        EXPECT_EQ(grid->tree().getValue(piece_->volume->grids().space.index(200, 0, 0)), grid->background()) << name;
    }
}

TEST_F(FogFileTest, TheUpAxisIsKept) {
    VolumeFileOptions options;
    options.up = "z";
    writeVolume(*piece_->volume, folder_ / "a.vdb", options);
    EXPECT_EQ(upAxisOf(folder_ / "a.vdb"), "z");
    writeVolume(*piece_->volume, folder_ / "b.vdb");
    EXPECT_EQ(upAxisOf(folder_ / "b.vdb"), "");
    EXPECT_THROW(upAxisOf(folder_ / "c.vdb"), RunError);
}

} // namespace
} // namespace patina
