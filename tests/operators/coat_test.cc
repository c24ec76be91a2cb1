#include "operators/coat.h"

#include "base/errors.h"

#include "support/exact_volume.h"
#include "support/volume_meter.h"
#include "volume/band.h"
#include "volume/layer_statistics.h"
#include "volume/nest_grids.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Thickness = std::function<double(const Imath::V3d& position)>;

// Rms over the surface of (layer's thickness - truth), µm.
double rmsError(const test::Piece& piece, int layer, const Thickness& truth) {
    const StackProbe probe(*piece.volume);
    std::vector<double> um(piece.volume->layerCount());
    double sum = 0.0;
    for (std::size_t v = 0; v < piece.surface.positions.size(); ++v) {
        const Imath::V3d position(piece.surface.positions[v]);
        probe.read(position, Imath::V3d(piece.surface.normals[v]), um.data());
        sum += std::pow(um[layer - 1] - truth(position), 2);
    }
    return std::sqrt(sum / static_cast<double>(piece.surface.positions.size()));
}

TEST(Coat, FilmsFromATwentiethToTwoVoxelsAreExact) {
    for (const double t : {0.05, 0.3, 1.2, 2.0}) {
        const auto piece = test::makePiece(test::sphere(60.f, 6), test::voxelScale(), 7.0);
        auto work = piece->work();
        coat(work, "soot", t, nullptr, piece->progress);
        // DESIGN: 0.0001 … 0.0011 for the shift alone on an exact sphere; 0.003 is what is promised.
        EXPECT_LT(rmsError(*piece, 1, [t](const Imath::V3d&) { return t; }), 0.003) << t;
    }
}

TEST(Coat, TrueScaleFilmsOfAThousandthOfAVoxelStandToHalfAPercent) {
    // A statue at 512 voxels: 391 µm a voxel, films of 0.35, 1.2, 3 and 1.8 µm on top of each other, on a round body.
    VolumeScale scale;
    scale.voxelSize = 391e-6;
    const auto piece = test::makePiece(test::sphere(40.f * 391e-6f, 6), scale);
    auto work = piece->work();
    const std::vector<double> films = {0.35, 1.2, 3.0, 1.8};
    for (std::size_t k = 0; k < films.size(); ++k)
        coat(work, "film" + std::to_string(k), films[k], nullptr, piece->progress);
    for (std::size_t k = 0; k < films.size(); ++k)
        EXPECT_LT(rmsError(*piece, int(k) + 1, [&](const Imath::V3d&) { return films[k]; }), 0.005 * films[k]) << k;
}

TEST(Coat, OnASheetReachesItsEdgeAndLeavesTheBackBare) {
    const auto piece = test::makePiece(test::sheet(24.f, 12), test::voxelScale(), 3.0);
    auto work = piece->work();
    coat(work, "soot", 0.05, nullptr, piece->progress);
    const StackProbe probe(*piece->volume);
    const double back = -sheetBackVoxels;
    for (double s = 0.05; s < 24.0; s += 0.31)
        for (const Imath::V3d& p : {Imath::V3d(0.02, s, 0.0), Imath::V3d(23.98, s, 0.0), Imath::V3d(s, 0.02, 0.0)}) {
            double um = 0.0;
            ASSERT_TRUE(probe.read(p, {0.0, 0.0, 1.0}, &um).found) << p.x << ' ' << p.y;
            EXPECT_NEAR(um, 0.05, 1e-4) << p.x << ' ' << p.y;
            if (s > 3.0 && s < 21.0) {
                ASSERT_TRUE(probe.read({s, 12.0, back}, {0.0, 0.0, -1.0}, &um).found) << s;
                EXPECT_EQ(um, 0.0) << s;
            }
        }
}

TEST(Coat, AMapIsReadAtTheClosestPointOfTheSurface) {
    const auto piece = test::makePiece(test::sphere(24.f, 5), test::voxelScale(), 7.0);
    auto work = piece->work();
    const auto factor = [](const Imath::V3d& p) { return 0.5 + 0.5 * std::sin(p.x / 3.0); };
    const test::FunctionMap map([&](const MapPoint& point) { return factor(point.position); });
    coat(work, "soot", 1.0, &map, piece->progress);
    EXPECT_LT(rmsError(*piece, 1, [&](const Imath::V3d& p) { return factor(p); }), 0.012);
}

TEST(Coat, ASecondCoatOnASlopeIsMeasuredAlongItsOwnNormal) {
    // The first coat makes a slope of 1 on a flat sheet; the second lies on it with its thickness along the slope's
    // normal, so read along the base's normal it is longer by 1 / cos 45°.
    const auto piece = test::makePiece(test::sheet(60.f, 60), test::voxelScale(), 40.0);
    auto work = piece->work();
    const test::FunctionMap wedge(
        [](const MapPoint& point) { return std::clamp((point.position.x - 10.0) / 30.0, 0.0, 1.0); });
    coat(work, "soot", 30.0, &wedge, piece->progress);
    coat(work, "dirt", 0.1, nullptr, piece->progress);
    const StackProbe probe(*piece->volume);
    double um[2];
    double sum = 0.0, first = 0.0;
    int count = 0;
    for (double x = 16.0; x <= 34.0; x += 0.37, ++count) {
        probe.read({x, 30.0, 0.0}, {0.0, 0.0, 1.0}, um);
        sum += std::pow(um[1] - 0.1 * std::sqrt(2.0), 2);
        first += std::pow(um[0] - (x - 10.0), 2);
    }
    EXPECT_LT(std::sqrt(sum / count), 0.003);
    EXPECT_LT(std::sqrt(first / count), 0.15);
}

TEST(Coat, OfNothingChangesNoBitOfTheInterface) {
    const auto piece = test::makePiece(test::sphere(15.f, 4), test::voxelScale());
    auto work = piece->work();
    coat(work, "soot", 0.4, nullptr, piece->progress);
    const auto before = piece->volume->grids().surface().deepCopy();
    const test::FunctionMap none([](const MapPoint&) { return 0.0; });
    coat(work, "dirt", 5.0, &none, piece->progress);
    for (auto voxel = before->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(piece->volume->grids().surface().tree().getValue(voxel.getCoord()), *voxel);
}

TEST(Coat, TheSameMaterialExtendsItsLayer) {
    const auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    auto work = piece->work();
    coat(work, "soot", 0.2, nullptr, piece->progress);
    coat(work, "soot", 0.3, nullptr, piece->progress);
    ASSERT_EQ(piece->volume->layerCount(), 1);
    EXPECT_LT(rmsError(*piece, 1, [](const Imath::V3d&) { return 0.5; }), 0.005);
}

TEST(Coat, FactorsOutsideZeroToOneAreClampedAndCounted) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    auto work = piece->work();
    const test::FunctionMap wild([](const MapPoint& point) { return point.normal.z > 0.0 ? 7.0 : -3.0; });
    const OperationReport report = coat(work, "soot", 0.5, &wild, piece->progress);
    EXPECT_GT(report.clampedAbove, 0u);
    EXPECT_GT(report.clampedBelow, 0u);
    const StackStatistics stack = measureStack(*piece->volume, piece->surface);
    EXPECT_NEAR(stack.layers[0].maxUm, 0.5, 0.02);
}

TEST(Coat, TheBackOfASheetTakesNothing) {
    const auto piece = test::makePiece(test::sheet(30.f, 15), test::voxelScale());
    auto work = piece->work();
    coat(work, "soot", 0.5, nullptr, piece->progress);
    const NestGrids& grids = piece->volume->grids();
    const openvdb::Coord front = grids.space.index(15, 15, 0), back = grids.space.index(15, 15, -8);
    EXPECT_NEAR(grids.base->tree().getValue(front) - grids.surface().tree().getValue(front), 0.5, 1e-4);
    EXPECT_EQ(grids.base->tree().getValue(back), grids.surface().tree().getValue(back));
}

TEST(Coat, GrowsTheBandWhereItIsTooThin) {
    const auto piece = test::makePiece(test::sphere(20.f, 5), test::voxelScale(), 4.0);
    auto work = piece->work();
    EXPECT_TRUE(coat(work, "soot", 6.0, nullptr, piece->progress).grewBand);
    EXPECT_LT(rmsError(*piece, 1, [](const Imath::V3d&) { return 6.0; }), 0.005);
}

TEST(Coat, ABoxGrowsToSteinersVolume) {
    // Edges in the lattice's directions; the parallel body of a box is V + S t + M t^2 + 4/3 pi t^3.
    const double a = 40.0, b = 30.0, c = 20.0;
    const auto steiner = [&](double t) {
        return a * b * c + 2.0 * (a * b + b * c + c * a) * t + M_PI * (a + b + c) * t * t + 4.0 / 3.0 * M_PI * t * t * t;
    };
    const auto exact = [&](double t) {
        return test::volumeOf(
            [&](const Imath::V3d& p) {
                return test::boxDistance(p + Imath::V3d(0.31, 0.17, 0.42), {a / 2, b / 2, c / 2}) - t;
            },
            36, 4.0 + t, 4.0);
    };
    for (const double t : {2.0, 5.0, 8.0}) {
        // The meter on the exact field of the parallel body.
        EXPECT_NEAR(test::volumeWithin(*exact(t).grids().base) / steiner(t), 1.0, 2e-4) << t;
        // The distance carried outward from a band of four voxels, as a coat thicker than the band has it.
        LayerVolume volume = exact(0.0);
        ensureExteriorBand(volume, t + 4.0);
        auto grown = volume.grids().base->deepCopy();
        for (FloatLeaf* leaf : leavesOf(grown->tree()))
            for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
                voxel.setValue(*voxel - static_cast<float>(t));
        EXPECT_NEAR(test::volumeWithin(*grown) / steiner(t), 1.0, 1e-3) << t;
    }
}

TEST(Coat, CancellingLeavesTheVolumeAsItWas) {
    const auto piece = test::makePiece(test::sphere(15.f, 4), test::voxelScale());
    const std::string before = contentHash(*piece->volume);
    auto work = piece->work();
    piece->progress.cancel();
    EXPECT_THROW(coat(work, "soot", 0.5, nullptr, piece->progress), Error);
    EXPECT_EQ(contentHash(*piece->volume), before);
}

} // namespace
} // namespace patina
