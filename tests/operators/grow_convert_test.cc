#include "operators/coat.h"
#include "operators/convert.h"
#include "operators/grow_layer.h"
#include "support/relief_surfaces.h"
#include "volume/layer_statistics.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

const test::Height flat = [](double, double) { return 0.0; };

// Rms over the surface of (layer's thickness - truth), µm.
double rmsError(const test::Piece& piece, int layer, double truth) {
    const StackProbe probe(*piece.volume);
    std::vector<double> um(piece.volume->layerCount());
    double sum = 0.0;
    for (std::size_t v = 0; v < piece.surface.positions.size(); ++v) {
        probe.read(Imath::V3d(piece.surface.positions[v]), Imath::V3d(piece.surface.normals[v]), um.data());
        sum += std::pow(um[layer - 1] - truth, 2);
    }
    return std::sqrt(sum / static_cast<double>(piece.surface.positions.size()));
}

TEST(GrowLayer, ThickensWhereItLiesAndFilmsAboveKeepTheirThickness) {
    for (const double grown : {0.02, 0.7, 2.5}) {
        const auto piece = test::makePiece(test::sphere(40.f, 6), test::voxelScale(), 9.0);
        auto work = piece->work();
        coat(work, "cuprite_2", 0.3, nullptr, piece->progress);
        coat(work, "soot", 0.01, nullptr, piece->progress);
        coat(work, "dirt", 0.4, nullptr, piece->progress);
        growLayer(work, "cuprite_2", grown, nullptr, piece->progress);
        EXPECT_LT(rmsError(*piece, 1, 0.3 + grown), 0.005 * (0.3 + grown)) << grown;
        EXPECT_LT(rmsError(*piece, 2, 0.01), 0.005 * 0.01) << grown;
        EXPECT_LT(rmsError(*piece, 3, 0.4), 0.005 * 0.4) << grown;
        EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
    }
}

TEST(GrowLayer, FollowsItsMapAndGrowsNothingWhereTheLayerIsNot) {
    const auto piece = test::makePiece(test::sheet(60.f, 60), test::voxelScale(), 6.0);
    const test::FunctionMap left([](const MapPoint& point) { return point.position.x < 30.0 ? 1.0 : 0.0; });
    const test::FunctionMap ramp([](const MapPoint& point) { return point.position.y / 60.0; });
    auto work = piece->work();
    coat(work, "cuprite_2", 0.3, &left, piece->progress);
    coat(work, "dirt", 0.2, nullptr, piece->progress);
    growLayer(work, "cuprite_2", 0.6, &ramp, piece->progress);
    const test::Column column(*piece->volume, flat);
    for (double y = 8.0; y < 52.0; y += 2.3) {
        EXPECT_NEAR(column.thickness(1, 20.0, y), 0.3 + 0.6 * y / 60.0, 0.005);
        EXPECT_NEAR(column.thickness(1, 40.0, y), 0.0, 1e-6);
        EXPECT_NEAR(column.thickness(2, 20.0, y), 0.2, 0.002);
        EXPECT_NEAR(column.thickness(2, 40.0, y), 0.2, 0.002);
    }
}

TEST(GrowLayer, OfSeveralTheLowestThatIsThereGrows) {
    const auto piece = test::makePiece(test::sheet(60.f, 60), test::voxelScale(), 6.0);
    const test::FunctionMap left([](const MapPoint& point) { return point.position.x < 30.0 ? 1.0 : 0.0; });
    auto work = piece->work();
    coat(work, "cuprite_2", 0.3, &left, piece->progress);
    coat(work, "dirt", 0.2, nullptr, piece->progress);
    coat(work, "cuprite_2", 0.1, nullptr, piece->progress);
    growLayer(work, "cuprite_2", 0.5, nullptr, piece->progress);
    const test::Column column(*piece->volume, flat);
    EXPECT_NEAR(column.thickness(1, 20.0, 30.0), 0.8, 0.003);
    EXPECT_NEAR(column.thickness(3, 20.0, 30.0), 0.1, 0.001);
    EXPECT_NEAR(column.thickness(3, 40.0, 30.0), 0.6, 0.003);
}

TEST(GrowLayer, EverywhereBeginsAnewInItsPlaceWhereTheLayerIsNot) {
    const auto piece = test::makePiece(test::sheet(60.f, 60), test::voxelScale(), 6.0);
    const test::FunctionMap left([](const MapPoint& point) { return point.position.x < 30.0 ? 1.0 : 0.0; });
    auto work = piece->work();
    coat(work, "cuprite_2", 0.2, nullptr, piece->progress);
    coat(work, "posnjakite", 0.3, &left, piece->progress);
    coat(work, "dirt", 0.1, nullptr, piece->progress);
    growLayer(work, "posnjakite", 0.4, nullptr, piece->progress, true);
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"cuprite_2", "posnjakite", "dirt"}));
    const test::Column column(*piece->volume, flat);
    for (const double x : {12.0, 20.0, 40.0, 48.0}) {
        EXPECT_NEAR(column.thickness(1, x, 30.0), 0.2, 0.002) << x;
        EXPECT_NEAR(column.thickness(2, x, 30.0), x < 30.0 ? 0.7 : 0.4, 0.005) << x;
        EXPECT_NEAR(column.thickness(3, x, 30.0), 0.1, 0.001) << x;
    }
    // In the lowest where it is in several, and anew only where it is in none.
    coat(work, "posnjakite", 0.2, &left, piece->progress);
    growLayer(work, "posnjakite", 0.1, nullptr, piece->progress, true);
    const test::Column after(*piece->volume, flat);
    EXPECT_NEAR(after.thickness(2, 20.0, 30.0), 0.8, 0.005);
    EXPECT_NEAR(after.thickness(4, 20.0, 30.0), 0.2, 0.002);
    EXPECT_NEAR(after.thickness(2, 40.0, 30.0), 0.5, 0.005);
    EXPECT_NEAR(after.thickness(4, 40.0, 30.0), 0.0, 1e-4);
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

TEST(GrowLayer, EverywhereLaysOnTopWhatNoLayerHolds) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale(), 6.0);
    auto work = piece->work();
    coat(work, "dirt", 0.2, nullptr, piece->progress);
    growLayer(work, "posnjakite", 0.3, nullptr, piece->progress, true);
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"dirt", "posnjakite"}));
    EXPECT_LT(rmsError(*piece, 2, 0.3), 0.003);
}

TEST(GrowLayer, OfWhatIsNotThereDoesNothing) {
    const auto piece = test::makePiece(test::sphere(15.f, 4), test::voxelScale());
    auto work = piece->work();
    coat(work, "dirt", 0.2, nullptr, piece->progress);
    const std::string before = contentHash(*piece->volume);
    growLayer(work, "cuprite_2", 0.6, nullptr, piece->progress);
    EXPECT_EQ(contentHash(*piece->volume), before);
}

TEST(ConvertLayers, TurnsTheOuterPartAndKeepsTheSurface) {
    const auto piece = test::makePiece(test::sphere(40.f, 5), test::voxelScale(), 6.0);
    auto work = piece->work();
    coat(work, "posnjakite", 0.5, nullptr, piece->progress);
    coat(work, "dirt", 0.2, nullptr, piece->progress);
    const auto surface = piece->volume->grids().surface().deepCopy();
    convertLayers(work, "posnjakite", "brochantite", 0.6, nullptr, piece->progress);
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"posnjakite", "brochantite", "dirt"}));
    EXPECT_LT(rmsError(*piece, 1, 0.2), 0.003);
    EXPECT_LT(rmsError(*piece, 2, 0.3), 0.003);
    EXPECT_LT(rmsError(*piece, 3, 0.2), 0.001);
    for (auto voxel = surface->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(piece->volume->grids().surface().tree().getValue(voxel.getCoord()), *voxel);
    // Half of what is left: the new part joins what was converted before.
    convertLayers(work, "posnjakite", "brochantite", 0.5, nullptr, piece->progress);
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"posnjakite", "brochantite", "dirt"}));
    EXPECT_LT(rmsError(*piece, 1, 0.1), 0.001);
    EXPECT_LT(rmsError(*piece, 2, 0.4), 0.003);
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

TEST(ConvertLayers, AllOfItLeavesNothingAndMergesWithNeighbours) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale(), 6.0);
    auto work = piece->work();
    coat(work, "brochantite", 0.1, nullptr, piece->progress);
    coat(work, "posnjakite", 0.5, nullptr, piece->progress);
    coat(work, "brochantite", 0.2, nullptr, piece->progress);
    convertLayers(work, "posnjakite", "brochantite", 1.0, nullptr, piece->progress);
    ASSERT_EQ(piece->volume->layers(), (std::vector<std::string>{"brochantite"}));
    EXPECT_LT(rmsError(*piece, 1, 0.8), 0.008);
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

TEST(ConvertLayers, FollowsItsMapInEveryLayerOfTheMaterial) {
    const auto piece = test::makePiece(test::sheet(50.f, 50), test::voxelScale(), 6.0);
    const test::FunctionMap ramp([](const MapPoint& point) { return point.position.x / 50.0; });
    auto work = piece->work();
    coat(work, "posnjakite", 0.4, nullptr, piece->progress);
    coat(work, "dirt", 0.1, nullptr, piece->progress);
    coat(work, "posnjakite", 0.2, nullptr, piece->progress);
    convertLayers(work, "posnjakite", "brochantite", 1.0, &ramp, piece->progress);
    ASSERT_EQ(piece->volume->layers(),
              (std::vector<std::string>{"posnjakite", "brochantite", "dirt", "posnjakite", "brochantite"}));
    const test::Column column(*piece->volume, flat);
    for (double x = 6.0; x < 44.0; x += 1.7) {
        EXPECT_NEAR(column.thickness(2, x, 25.0), 0.4 * x / 50.0, 0.003);
        EXPECT_NEAR(column.thickness(1, x, 25.0), 0.4 * (1.0 - x / 50.0), 0.003);
        EXPECT_NEAR(column.thickness(5, x, 25.0), 0.2 * x / 50.0, 0.003);
    }
}

} // namespace
} // namespace patina
