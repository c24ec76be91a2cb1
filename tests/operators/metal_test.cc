// `erode … and metal`: the metal itself goes, the base stays the reference of heights.

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/polish.h"
#include "support/relief_surfaces.h"
#include "support/temporary_folder.h"
#include "volume/interior_band.h"
#include "volume/layer_statistics.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

StackProbe::Reading readAt(const LayerVolume& volume, const Imath::V3d& position, std::vector<double>& um) {
    um.assign(volume.layerCount() + 1, 0.0);
    return StackProbe(volume).read(position, Imath::V3d(position).normalized(), um.data());
}

TEST(ErodeAndMetal, GoesThroughTheLayersIntoTheMetalByHardness) {
    const auto piece = test::makePiece(test::sphere(40.f, 5), test::voxelScale());
    auto work = piece->work();
    coat(work, "soft", 0.4, nullptr, piece->progress);
    // 0.4 at hardness 0.5 costs 0.2; the remaining 0.6 take 0.6 / 3 = 0.2 of the metal.
    erode(work, 0.8, nullptr, {0.5}, piece->progress, 3.0);
    EXPECT_EQ(piece->volume->layerCount(), 0);
    std::vector<double> um;
    for (std::size_t v = 0; v < piece->surface.positions.size(); v += 37) {
        const auto reading = readAt(*piece->volume, Imath::V3d(piece->surface.positions[v]), um);
        ASSERT_TRUE(reading.found);
        EXPECT_NEAR(reading.metalHeight, -0.2, 0.008); // a percent of the 0.8 that the slope was read for
        EXPECT_NEAR(reading.height, -0.2, 0.008);
    }
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

TEST(ErodeAndMetal, DeepPitsMakeTheBandGrowInward) {
    const auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    auto work = piece->work();
    EXPECT_TRUE(erode(work, 5.0, nullptr, {}, piece->progress, 1.0).grewBand);
    EXPECT_GE(piece->volume->grids().interiorBand, 8.0);
    EXPECT_NEAR(metalDepthVoxels(*piece->volume), 5.0, 0.15);
    std::vector<double> um;
    for (std::size_t v = 0; v < piece->surface.positions.size(); v += 37)
        EXPECT_NEAR(readAt(*piece->volume, Imath::V3d(piece->surface.positions[v]), um).height, -5.0, 0.1);
}

TEST(ErodeAndMetal, ThatDoesNotComeSoFarLeavesNoMetalGrid) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    auto work = piece->work();
    coat(work, "soot", 0.5, nullptr, piece->progress);
    erode(work, 0.3, nullptr, {}, piece->progress, 1.0);
    EXPECT_EQ(piece->volume->grids().metal, nullptr);
    EXPECT_EQ(piece->volume->layerCount(), 1);
}

TEST(ErodeAndMetal, LayersLieOnWhatIsLeftAndHeightsAreMeasuredFromTheBase) {
    const auto piece = test::makePiece(test::sheet(50.f, 50), test::voxelScale(), 6.0);
    const test::FunctionMap pits([](const MapPoint& point) { return 0.5 + 0.5 * std::sin(point.position.x / 4.0); });
    auto work = piece->work();
    erode(work, 0.8, &pits, {}, piece->progress, 1.0);
    coat(work, "tarnish_1", 0.1, nullptr, piece->progress);
    fill(work, "dirt", 0.0, nullptr, piece->progress); // up to the bare metal as it was
    const test::Height flat = [](double, double) { return 0.0; };
    const test::Column column(*piece->volume, flat);
    for (double x = 8.0; x < 42.0; x += 0.83) {
        const double depth = 0.8 * (0.5 + 0.5 * std::sin(x / 4.0)), slope = 0.1 * std::cos(x / 4.0);
        const double film = 0.1 * std::hypot(1.0, slope);
        EXPECT_NEAR(column.thickness(1, x, 25.0), film, 0.005) << x;
        if (std::abs(depth - film) > 0.05) {
            EXPECT_NEAR(column.height(x, 25.0), std::max(film - depth, 0.0), 0.02) << x;
        }
        if (depth > film + 0.05) {
            EXPECT_NEAR(column.thickness(2, x, 25.0), depth - film, 0.02) << x;
        }
    }
    polish(work, 0.0, nullptr, piece->progress);
    for (double x = 8.0; x < 42.0; x += 0.83)
        EXPECT_LE(test::Column(*piece->volume, flat).height(x, 25.0), 0.003) << x;
    const StackStatistics stack = measureStack(*piece->volume, piece->surface);
    EXPECT_NEAR(stack.metalLoss.meanUm, 0.4, 0.03);
    EXPECT_GE(stack.metalLoss.maxUm, 0.77);
}

TEST(ErodeAndMetal, ComesBackFromAFileBitForBitAndGoesOn) {
    const test::TemporaryFolder folder;
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale(), 8.0);
    const test::FunctionMap pits([](const MapPoint& point) { return 0.5 + 0.5 * std::sin(point.position.x); });
    auto work = piece->work();
    erode(work, 0.8, &pits, {}, piece->progress, 1.0);
    coat(work, "tarnish_1", 0.3, nullptr, piece->progress);
    writeVolume(*piece->volume, folder / "pits.vdb");
    LayerVolume read = readVolume(folder / "pits.vdb");
    ASSERT_NE(read.grids().metal, nullptr);
    EXPECT_EQ(contentHash(read), contentHash(*piece->volume));
    EXPECT_EQ(contentHash(piece->volume->clone()), contentHash(*piece->volume));

    Workpiece again{read, *piece->binding};
    for (Workpiece* one : {&work, &again}) {
        erode(*one, 0.5, &pits, {}, piece->progress, 1.0);
        fill(*one, "dirt", 0.2, nullptr, piece->progress);
        polish(*one, 0.1, nullptr, piece->progress);
    }
    EXPECT_EQ(contentHash(read), contentHash(*piece->volume));
}

TEST(ErodeAndMetal, EatingThroughAThinPlateLeavesNoMetalAndNoSpikes) {
    // A sheet has a back 8 voxels behind it; 20 voxels of erosion go through.
    const auto piece = test::makePiece(test::sheet(40.f, 40), test::voxelScale());
    const test::FunctionMap hole([](const MapPoint& point) {
        return (Imath::V2d(point.position.x, point.position.y) - Imath::V2d(20.0, 20.0)).length() < 8.0 ? 1.0 : 0.0;
    });
    auto work = piece->work();
    erode(work, 20.0, &hole, {}, piece->progress, 1.0);
    std::vector<double> um(1);
    const auto reading = StackProbe(*piece->volume).read({20.0, 20.0, 0.0}, {0.0, 0.0, 1.0}, um.data());
    ASSERT_TRUE(reading.found);
    EXPECT_LE(reading.height, -3.5);
    EXPECT_GE(reading.height, -10.0);
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

} // namespace
} // namespace patina
