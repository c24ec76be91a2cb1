#include "operators/erode.h"

#include "operators/coat.h"
#include "support/test_surfaces.h"
#include "volume/layer_statistics.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

std::unique_ptr<test::Piece> twoLayers(double lower, double upper) {
    auto piece = test::makePiece(test::sphere(40.f, 5), test::voxelScale());
    auto work = piece->work();
    coat(work, "hard", lower, nullptr, piece->progress);
    coat(work, "soft", upper, nullptr, piece->progress);
    return piece;
}

std::vector<double> meanThickness(const test::Piece& piece) {
    std::vector<double> mean;
    for (const LayerStatistics& layer : measureStack(*piece.volume, piece.surface).layers)
        mean.push_back(layer.meanUm);
    return mean;
}

TEST(Erode, TakesFromTheTopDown) {
    const auto piece = twoLayers(0.3, 0.2);
    auto work = piece->work();
    erode(work, 0.35, nullptr, {}, piece->progress);
    // The upper layer is gone everywhere and dropped; the lower has lost the rest.
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"hard"}));
    EXPECT_NEAR(meanThickness(*piece)[0], 0.15, 0.002);
}

TEST(Erode, StopsAtTheMetal) {
    const auto piece = twoLayers(0.3, 0.2);
    auto work = piece->work();
    erode(work, 3.0, nullptr, {}, piece->progress);
    EXPECT_EQ(piece->volume->layerCount(), 0);
    const auto fresh = test::makePiece(test::sphere(40.f, 5), test::voxelScale());
    for (auto voxel = fresh->volume->grids().base->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(piece->volume->grids().base->tree().getValue(voxel.getCoord()), *voxel);
    for (auto voxel = fresh->volume->grids().material->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(piece->volume->grids().material->tree().getValue(voxel.getCoord()), *voxel);
}

TEST(Erode, ByHardnessASoftLayerGoesFaster) {
    // A budget of 0.5: the soft layer of 0.2 costs 0.2 · 0.5 = 0.1; the remaining 0.4 take 0.4 / 2 = 0.2 of the hard
    // one.
    const auto piece = twoLayers(0.5, 0.2);
    auto work = piece->work();
    erode(work, 0.5, nullptr, {2.0, 0.5}, piece->progress);
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"hard"}));
    EXPECT_NEAR(meanThickness(*piece)[0], 0.3, 0.003);
}

TEST(Erode, FollowsItsMap) {
    const auto piece = twoLayers(0.3, 0.4);
    auto work = piece->work();
    // A little more than is there, so that the slope's rounding leaves no film of nanometres.
    const test::FunctionMap half([](const MapPoint& point) { return point.normal.z > 0.0 ? 1.0 : 0.0; });
    erode(work, 0.42, &half, {}, piece->progress);
    const StackStatistics stack = measureStack(*piece->volume, piece->surface);
    ASSERT_EQ(stack.layers.size(), 2u);
    EXPECT_NEAR(stack.layers[1].coverage, 0.5, 0.03);
    EXPECT_NEAR(stack.layers[1].meanUm, 0.2, 0.01);
    EXPECT_NEAR(stack.layers[0].meanUm, 0.3 - 0.5 * 0.02, 0.003);
}

TEST(Erode, VolumeIsWhatWasThereLessWhatWasTaken) {
    const auto piece = twoLayers(0.3, 0.4);
    const double before = measureStack(*piece->volume, piece->surface).total.volumeM3;
    auto work = piece->work();
    erode(work, 0.25, nullptr, {}, piece->progress);
    const StackStatistics after = measureStack(*piece->volume, piece->surface);
    EXPECT_NEAR(before - after.total.volumeM3, 0.25e-6 * after.areaM2, 0.01 * 0.25e-6 * after.areaM2);
}

TEST(Erode, OfTheBareMetalDoesNothing) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    const std::string before = contentHash(*piece->volume);
    auto work = piece->work();
    erode(work, 1.0, nullptr, {}, piece->progress);
    EXPECT_EQ(contentHash(*piece->volume), before);
}

} // namespace
} // namespace patina
