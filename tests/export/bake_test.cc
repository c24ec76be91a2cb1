#include "export/bake.h"

#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

class BakeTest : public testing::Test {
  protected:
    // A sheet of 4 cm at true scale, half of it with 3 µm of patina over 1 µm of cuprite.
    void SetUp() override {
        VolumeScale scale;
        scale.voxelSize = 0.001;
        piece_ = test::makePiece(test::sheet(0.04f, 40), scale);
        auto work = piece_->work();
        const test::FunctionMap half([](const MapPoint& point) { return point.position.x > 0.02 ? 1.0 : 0.0; });
        coat(work, "cuprite_2", 1.0, nullptr, piece_->progress);
        coat(work, "marine_patina_3", 3.0, &half, piece_->progress);
    }
    StackOptics optics() const {
        return StackOptics({&library_.at("copper"), &library_.at("cuprite_2"), &library_.at("marine_patina_3")});
    }
    MapSet bakeAt(int resolution) const { return bakeAt(resolution, optics()); }
    MapSet bakeAt(int resolution, const StackOptics& optics) const {
        BakeOptions options;
        options.resolution = resolution;
        options.materialId = true;
        Progress progress;
        return bake(*piece_->volume, piece_->surface, optics, options, progress);
    }

    std::unique_ptr<test::Piece> piece_;
    MaterialLibrary library_ = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
};

TEST_F(BakeTest, MapsHaveTheirPromisedNames) {
    const MapSet maps = bakeAt(32);
    std::vector<std::string> names;
    for (const MapImage& map : maps.maps)
        names.push_back(map.name);
    EXPECT_THAT(names,
                testing::ElementsAre("displacement", "diffuse", "lobe_00_copper", "lobe_01_cuprite_2",
                                     "lobe_02_marine_patina_3", "base_color", "metallic", "roughness", "normal",
                                     "thickness_01_cuprite_2", "coverage_01_cuprite_2", "thickness_02_marine_patina_3",
                                     "coverage_02_marine_patina_3", "material_id"));
}

TEST_F(BakeTest, ThicknessIsInMicrometresAndDisplacementInSceneUnits) {
    const MapSet maps = bakeAt(64);
    const int row = 32 * 64;
    const auto& cuprite = maps.find("thickness_01_cuprite_2")->floats;
    const auto& patina = maps.find("thickness_02_marine_patina_3")->floats;
    const auto& height = maps.find("displacement")->floats;
    // Away from the step and the rim.
    for (const int x : {8, 16, 24})
        EXPECT_NEAR(cuprite[row + x], 1.0, 0.005) << x;
    for (const int x : {40, 48, 56}) {
        EXPECT_NEAR(patina[row + x], 3.0, 0.015) << x;
        EXPECT_NEAR(height[row + x], 4e-6, 2e-8) << x;
    }
    for (const int x : {8, 16, 24}) {
        EXPECT_NEAR(patina[row + x], 0.0, 1e-4) << x;
        EXPECT_NEAR(height[row + x], 1e-6, 1e-8) << x;
    }
    EXPECT_EQ(maps.find("material_id")->floats[row + 16], 2.f);
    EXPECT_EQ(maps.find("material_id")->floats[row + 48], 3.f);
    EXPECT_EQ(float(maps.find("coverage_02_marine_patina_3")->halves[row + 48]), 1.f);
    EXPECT_EQ(float(maps.find("coverage_01_cuprite_2")->halves[row + 48]), 0.f);
}

TEST_F(BakeTest, ColoursAreThoseOfTheStack) {
    const MapSet maps = bakeAt(64);
    Appearance look;
    const float um[2] = {1.f, 3.f};
    optics().evaluate(um, look);
    const auto& diffuse = maps.find("diffuse")->halves;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(float(diffuse[(32 * 64 + 48) * 3 + c]), look.diffuse[c], 0.003f);
}

// ACEScg maps are the Rec.709 ones, converted: white stays white, and no colour of this sheet leaves Rec.709.
TEST_F(BakeTest, AcescgIsRec709Converted) {
    const MapSet rec709 = bakeAt(32), acescg = bakeAt(32, optics().in(ColourSpace::acescg));
    int compared = 0;
    double farthest = 0.0;
    for (const char* name : {"diffuse", "base_color"}) {
        const auto &from = rec709.find(name)->halves, &to = acescg.find(name)->halves;
        EXPECT_EQ(acescg.find(name)->colourSpace, ColourSpace::acescg);
        ASSERT_EQ(from.size(), to.size());
        for (std::size_t i = 0; i + 2 < from.size(); i += 3) {
            const Imath::V3d rgb(from[i], from[i + 1], from[i + 2]);
            if (rgb.x <= 0.0 || rgb.y <= 0.0 || rgb.z <= 0.0)
                continue; // beside the sheet, or at the edge of the gamut
            const Imath::V3d expected = acescgFromXyz(xyzFromLinearRec709(rgb));
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(float(to[i + c]), expected[c], 1e-3) << name << " " << i; // half floats
                farthest = std::max(farthest, std::abs(expected[c] - rgb[c]));
            }
            ++compared;
        }
    }
    EXPECT_GT(compared, 1000);
    EXPECT_GT(farthest, 0.01); // or a bake that ignores the space would pass
}

TEST_F(BakeTest, TheNormalIsFlatAwayFromTheStep) {
    const MapSet maps = bakeAt(64);
    const auto& normal = maps.find("normal")->halves;
    const std::size_t at = (32 * 64 + 16) * 3;
    EXPECT_NEAR(float(normal[at]), 0.5f, 1e-3f);
    EXPECT_NEAR(float(normal[at + 1]), 0.5f, 1e-3f);
    EXPECT_NEAR(float(normal[at + 2]), 1.0f, 1e-3f);
}

TEST_F(BakeTest, TheSummaryCountsWhatIsCovered) {
    const MapSet maps = bakeAt(32);
    EXPECT_NEAR(maps.summary.coveredFraction, 1.0, 1e-9);
    EXPECT_LT(maps.summary.unreadableFraction, 0.01);
    EXPECT_GE(maps.summary.maxDisplacement, 3.9e-6f);
}

} // namespace
} // namespace patina
