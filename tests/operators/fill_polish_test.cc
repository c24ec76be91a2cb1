#include "operators/coat.h"
#include "operators/fill.h"
#include "operators/polish.h"
#include "support/relief_surfaces.h"
#include "support/smooth_reader.h"
#include "volume/layer_statistics.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// Bases with closed forms, 60 voxels wide. Where heights are measured the sheets' edges are far.
constexpr double low = 15.0, high = 45.0;
const test::Height flat = [](double, double) { return 0.0; };
const test::Height wave = [](double x, double) { return 2.0 * std::sin(2.0 * M_PI * x / 30.0); };
const test::Height groove = [](double x, double) { return std::abs(x - 30.0); };

double heightAlongNormal(const test::Piece& piece, const Imath::V3d& position, const Imath::V3d& normal) {
    std::vector<double> um(piece.volume->layerCount() + 1);
    const auto reading = StackProbe(*piece.volume).read(position, normal, um.data());
    EXPECT_TRUE(reading.found);
    return reading.height;
}

Imath::V3d normalOf(const test::Height& height, double x, double y) {
    const double e = 1e-3;
    return Imath::V3d(-(height(x + e, y) - height(x - e, y)) / (2 * e),
                      -(height(x, y + e) - height(x, y - e)) / (2 * e), 1.0)
        .normalized();
}

TEST(Fill, StandsAtItsHeightAboveAnyMetal) {
    for (const auto& base : {flat, wave, groove}) {
        const auto piece = test::makePiece(test::relief(60.f, 120, base), test::voxelScale(), 6.0);
        auto work = piece->work();
        coat(work, "soot", 0.2, nullptr, piece->progress);
        fill(work, "dirt", 1.3, nullptr, piece->progress);
        ASSERT_EQ(piece->volume->layerCount(), 2);
        for (double x = low; x <= high; x += 1.37) {
            if (std::abs(x - 30.0) < 4.0)
                continue; // the groove's bottom: no one normal
            const double y = 20.0 + 0.3 * x;
            EXPECT_NEAR(heightAlongNormal(*piece, {x, y, base(x, y)}, normalOf(base, x, y)), 1.3, 0.02) << x;
        }
    }
}

TEST(Fill, OfASphereHasSteinersVolume) {
    const auto piece = test::makePiece(test::sphere(30.f, 6), test::voxelScale(), 6.0);
    auto work = piece->work();
    fill(work, "dirt", 1.5, nullptr, piece->progress);
    // Per area of the sphere: t + t² / R + t³ / (3 R²).
    const StackProbe probe(*piece->volume);
    double sum = 0.0, um;
    for (const Imath::V3f& p : piece->surface.positions) {
        probe.read(Imath::V3d(p), Imath::V3d(p).normalized(), &um);
        const double r = 30.0;
        sum += (std::pow(r + um, 3) - r * r * r) / (3.0 * r * r);
    }
    const double exact = 1.5 + 1.5 * 1.5 / 30.0 + std::pow(1.5, 3) / 2700.0;
    EXPECT_NEAR(sum / static_cast<double>(piece->surface.positions.size()), exact, 0.005 * exact);
}

TEST(Fill, VolumesOfGrooveAndWaveAreWithinHalfAPercent) {
    {
        const auto piece = test::makePiece(test::relief(60.f, 120, groove), test::voxelScale(), 8.0);
        auto work = piece->work();
        fill(work, "dirt", 2.0, nullptr, piece->progress);
        const test::Column column(*piece->volume, groove);
        // Two slabs of 2 on flanks of 45° over 15 √2 each, less what they share at the bisector: h² cot 45°.
        const double exact = (2.0 * 15.0 * std::sqrt(2.0) * 2.0 - 4.0) / 30.0;
        // At the window's ends the slab ends along the normal, not along z: what is missing there stands to the side.
        const double beyond = 2.0 * 0.5 * 2.0 * 2.0 / 30.0;
        const double mean =
            test::meanOver(low, high, 301, [&](double x, double) { return column.height(x, 30.0); });
        EXPECT_NEAR(mean, exact + beyond, 0.005 * exact);
    }
    {
        const auto piece = test::makePiece(test::relief(60.f, 120, wave), test::voxelScale(), 6.0);
        auto work = piece->work();
        fill(work, "dirt", 0.8, nullptr, piece->progress);
        const test::Column column(*piece->volume, wave);
        // A strip along a whole period: thickness times arc length, the turns cancel.
        const double arc = test::meanOver(low, high, 1000, [](double x, double) {
            return std::hypot(1.0, 2.0 * 2.0 * M_PI / 30.0 * std::cos(2.0 * M_PI * x / 30.0));
        });
        const double mean =
            test::meanOver(low, high, 301, [&](double x, double) { return column.height(x, 30.0); });
        EXPECT_NEAR(mean, 0.8 * arc, 0.005 * 0.8 * arc);
    }
}

TEST(Fill, LeavesWhatStandsHigherAndAddsNothingThere) {
    const auto piece = test::makePiece(test::sheet(40.f, 40), test::voxelScale(), 6.0);
    auto work = piece->work();
    const test::FunctionMap left([](const MapPoint& point) { return point.position.x < 20.0 ? 1.0 : 0.2; });
    coat(work, "soot", 1.0, &left, piece->progress);
    fill(work, "dirt", 0.5, nullptr, piece->progress);
    const test::Column column(*piece->volume, flat);
    EXPECT_NEAR(column.height(12.0, 20.0), 1.0, 0.01);
    EXPECT_EQ(column.thickness(2, 12.0, 20.0), 0.0);
    EXPECT_NEAR(column.height(28.0, 20.0), 0.5, 0.01);
    EXPECT_NEAR(column.thickness(2, 28.0, 20.0), 0.3, 0.01);
}

TEST(Fill, BelowTheSurfaceChangesNoBit) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    auto work = piece->work();
    coat(work, "soot", 0.5, nullptr, piece->progress);
    const auto layers = piece->volume->layers();
    const auto before = piece->volume->grids().surface().deepCopy();
    fill(work, "dirt", 0.1, nullptr, piece->progress);
    EXPECT_EQ(piece->volume->layers(), layers);
    for (auto voxel = before->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(piece->volume->grids().surface().tree().getValue(voxel.getCoord()), *voxel);
}

TEST(Fill, OfTheSameMaterialExtendsItsLayerAndItsMapMultipliesTheHeight) {
    const auto piece = test::makePiece(test::sheet(40.f, 40), test::voxelScale(), 6.0);
    auto work = piece->work();
    fill(work, "dirt", 0.4, nullptr, piece->progress);
    const test::FunctionMap ramp([](const MapPoint& point) { return point.position.x / 40.0; });
    fill(work, "dirt", 1.6, &ramp, piece->progress);
    ASSERT_EQ(piece->volume->layerCount(), 1);
    const test::Column column(*piece->volume, flat);
    for (double x = 6.0; x < 36.0; x += 1.3)
        if (std::abs(x - 10.0) > 1.5) { // a crease narrower than a voxel
            EXPECT_NEAR(column.height(x, 20.0), std::max(0.4, 1.6 * x / 40.0), 0.02) << x;
        }
}

TEST(Fill, AboveSmoothOfAVGrooveHoldsTheClosedFormsVolume) {
    // Below a ball of radius r that touches both walls lie r² (cot phi - pi / 2 + phi) per length.
    const double r = 6.0;
    for (const double angle : {30.0, 45.0, 60.0}) {
        const double phi = angle * M_PI / 180.0, depth = r * std::cos(phi) / std::tan(phi) + 3.0;
        const test::Height groove = [&](double x, double) {
            return std::min(0.0, std::abs(x - 30.0) / std::tan(phi) - depth);
        };
        const auto piece = test::makePiece(test::relief(60.f, 120, groove), test::voxelScale(), 6.0);
        auto work = piece->work();
        fill(work, "dirt", 0.0, nullptr, piece->progress, r);
        ASSERT_EQ(piece->volume->layerCount(), 1) << angle;
        // Above the groove itself and read tricubically: the trilinear zero of a surface of curvature 1 / r lies
        // 1 / (12 r) voxels inside it in the mean, which is 0.7 to 4 % of these small areas.
        const test::SmoothReader surface(piece->volume->grids().surface());
        double area = 0.0, worst = 0.0;
        const double half = r * std::cos(phi), step = half / 200.0; // where the ball touches
        for (double x = 30.0 - half + 0.5 * step; x < 30.0 + half; x += step) {
            const double bottom = groove(x, 0.0), ball = r / std::sin(phi) - depth;
            const double height = bottom + surface.crossing({x, 30.3, bottom}, {0.0, 0.0, 1.0}, -0.5, r + 1.0);
            const double expected = ball - std::sqrt(r * r - (x - 30.0) * (x - 30.0));
            area += step * (height - bottom);
            worst = std::max(worst, std::abs(height - expected));
        }
        const double expected = r * r * (1.0 / std::tan(phi) - M_PI / 2.0 + phi);
        RecordProperty("area_error_" + std::to_string(int(angle)), std::to_string(area / expected - 1.0));
        EXPECT_NEAR(area / expected, 1.0, 0.005) << angle;
        EXPECT_LT(worst, 0.02) << angle;
        const test::Column column(*piece->volume, groove);
        for (const double side : {-1.0, 1.0})
            EXPECT_LT(column.thickness(1, 30.0 + side * (half + 1.5), 30.3), 1e-3) << angle;
    }
}

TEST(Fill, GrowsTheBandAndSparesTheBackOfASheet) {
    const auto piece = test::makePiece(test::sheet(40.f, 40), test::voxelScale(), 4.0);
    auto work = piece->work();
    EXPECT_TRUE(fill(work, "dirt", 6.0, nullptr, piece->progress).grewBand);
    EXPECT_NEAR(test::Column(*piece->volume, flat).height(20.0, 20.0), 6.0, 0.05);
    const NestGrids& grids = piece->volume->grids();
    const openvdb::Coord back = grids.space.index(20, 20, -8);
    EXPECT_EQ(grids.base->tree().getValue(back), grids.surface().tree().getValue(back));
}

TEST(Polish, CutsToItsHeightAboveAnyMetalAndKeepsWhatIsLower) {
    for (const auto& base : {flat, wave, groove}) {
        const auto piece = test::makePiece(test::relief(60.f, 120, base), test::voxelScale(), 6.0);
        auto work = piece->work();
        const auto pattern = [](const Imath::V3d& p) { return 0.5 + 0.5 * std::sin(p.y / 2.5); };
        const test::FunctionMap map([&](const MapPoint& point) { return pattern(point.position); });
        coat(work, "soot", 0.3, nullptr, piece->progress);
        coat(work, "dirt", 1.0, &map, piece->progress);
        polish(work, 0.7, nullptr, piece->progress);
        for (double x = low; x <= high; x += 1.37) {
            if (std::abs(x - 30.0) < 4.0)
                continue;
            const double y = 20.0 + 0.3 * x;
            const double expected = std::min(0.7, 0.3 + pattern({x, y, 0.0}));
            if (std::abs(0.3 + pattern({x, y, 0.0}) - 0.7) > 0.15) { // beside the edge of a plateau
                EXPECT_NEAR(heightAlongNormal(*piece, {x, y, base(x, y)}, normalOf(base, x, y)), expected, 0.02) << x;
            }
        }
    }
}

TEST(Polish, DropsLayersThatAreGoneAndMergesThoseThatMeet) {
    const auto piece = test::makePiece(test::sheet(40.f, 40), test::voxelScale(), 6.0);
    auto work = piece->work();
    const test::FunctionMap left([](const MapPoint& point) { return point.position.x < 20.0 ? 1.0 : 0.0; });
    coat(work, "soot", 0.3, nullptr, piece->progress);
    coat(work, "dirt", 0.5, &left, piece->progress);
    coat(work, "soot", 0.2, nullptr, piece->progress);
    ASSERT_EQ(piece->volume->layerCount(), 3);
    polish(work, 0.3, nullptr, piece->progress);
    EXPECT_EQ(piece->volume->layers(), std::vector<std::string>{"soot"});
    polish(work, 0.0, nullptr, piece->progress);
    EXPECT_EQ(piece->volume->layerCount(), 0);
    EXPECT_EQ(updateMaterialIds(*piece->volume), 0u);
}

TEST(Polish, TheMapMultipliesTheHeight) {
    const auto piece = test::makePiece(test::sheet(40.f, 40), test::voxelScale(), 6.0);
    auto work = piece->work();
    coat(work, "soot", 1.5, nullptr, piece->progress);
    const test::FunctionMap ramp([](const MapPoint& point) { return point.position.x / 40.0; });
    polish(work, 2.0, &ramp, piece->progress);
    const test::Column column(*piece->volume, flat);
    for (double x = 6.0; x < 36.0; x += 1.3)
        if (std::abs(x - 30.0) > 1.5) {
            EXPECT_NEAR(column.height(x, 20.0), std::min(1.5, 2.0 * x / 40.0), 0.02) << x;
        }
}

TEST(Polish, AndFillTakeAndBringWhatTheAbbottCurveSays) {
    // A relief of amplitude 0.4 about 0.5: cut at 0.5, it loses a / π; filled to 0.5, it gains a / π.
    const auto piece = test::makePiece(test::sheet(60.f, 60), test::voxelScale(), 6.0);
    const auto pattern = [](double x) { return (0.5 + 0.4 * std::sin(2.0 * M_PI * x / 30.0)) / 0.9; };
    const test::FunctionMap map([&](const MapPoint& point) { return pattern(point.position.x); });
    auto work = piece->work();
    coat(work, "soot", 0.9, &map, piece->progress);
    LayerVolume polished = piece->volume->clone();
    Workpiece other{polished, *piece->binding};
    polish(other, 0.5, nullptr, piece->progress);
    fill(work, "dirt", 0.5, nullptr, piece->progress);
    const auto mean = [](const LayerVolume& volume) {
        const test::Column column(volume, flat);
        return test::meanOver(low, high, 301, [&](double x, double) { return column.height(x, 30.0); });
    };
    EXPECT_NEAR(mean(polished), 0.5 - 0.4 / M_PI, 0.005 * 0.4 / M_PI + 0.001);
    EXPECT_NEAR(mean(*piece->volume), 0.5 + 0.4 / M_PI, 0.005 * 0.4 / M_PI + 0.001);
}

} // namespace
} // namespace patina
