#include "operators/material_ratio.h"

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/surface_samples.h"
#include "support/relief_surfaces.h"
#include "volume/layer_statistics.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

constexpr double size = 90.0;
const test::Height flat = [](double, double) { return 0.0; };

// A flat sheet of 90 voxels coated with a relief z = 1 + height(x, y).
std::unique_ptr<test::Piece> coatedWith(const test::Height& height) {
    auto piece = test::makePiece(test::sheet(float(size), 90), test::voxelScale(), 7.0);
    const test::FunctionMap map(
        [&](const MapPoint& point) { return (1.0 + height(point.position.x, point.position.y)) / 2.5; });
    auto work = piece->work();
    coat(work, "soot", 2.5, &map, piece->progress);
    return piece;
}

double areaHigherThan(const LayerVolume& volume, double height) {
    const test::Column column(volume, flat);
    return test::meanOver(0.0, size, 400,
                          [&](double x, double y) { return column.height(x, y) >= height ? 1.0 : 0.0; });
}

double meanHeight(const LayerVolume& volume) {
    const test::Column column(volume, flat);
    return test::meanOver(15.0, 75.0, 300, [&](double x, double y) { return column.height(x, y); }); // off the edges
}

// All that was higher now stands at the height, all else is as it was.
void expectCutAt(double height, const LayerVolume& before, const LayerVolume& after) {
    const test::Column then(before, flat), now(after, flat);
    double worst = 0.0;
    test::meanOver(2.0, size - 2.0, 150, [&](double x, double y) {
        worst = std::max(worst, std::abs(now.height(x, y) - std::min(then.height(x, y), height)));
        return 0.0;
    });
    EXPECT_LT(worst, 0.02);
}

TEST(PolishArea, OfASinusoidFollowsItsAbbottCurve) {
    // Amplitude a: c = a cos(πA), removed a (sin πA - πA cos πA) / π per area.
    const double a = 0.4;
    for (const double fraction : {0.1, 0.5, 0.75}) {
        const auto piece = coatedWith([&](double x, double) { return a * std::sin(2.0 * M_PI * x / 30.0); });
        const LayerVolume before = piece->volume->clone();
        auto work = piece->work();
        AreaPolish what;
        what.fraction = fraction;
        const OperationReport report = polishArea(work, what, piece->progress);
        const double cut = 1.0 + a * std::cos(M_PI * fraction);
        ASSERT_TRUE(report.heightUm);
        EXPECT_NEAR(*report.heightUm, cut, 0.02) << fraction;
        EXPECT_NEAR(areaHigherThan(before, *report.heightUm), fraction, 0.005) << fraction;
        expectCutAt(*report.heightUm, before, *piece->volume);
        // Off the sheet's edges, which have a say in the height: a (sin πA - πA cos πA) / π at the A of the height
        // found.
        const double part = std::acos((*report.heightUm - 1.0) / a) / M_PI;
        const double removed = a * (std::sin(M_PI * part) - M_PI * part * std::cos(M_PI * part)) / M_PI;
        EXPECT_NEAR(meanHeight(before) - meanHeight(*piece->volume), removed, 0.005 * removed + 0.0005) << fraction;
    }
}

TEST(PolishArea, OfAGaussianFieldFollowsItsAbbottCurve) {
    // The field's own heights are the truth; of an endless one c = σ Φ⁻¹(1 - A) (ISO 25178-2).
    const test::GaussianField field;
    const double sigma = 0.05;
    std::vector<double> heights;
    test::meanOver(0.0, size, 700, [&](double x, double y) {
        heights.push_back(1.0 + sigma * field(x, y));
        return 0.0;
    });
    std::sort(heights.rbegin(), heights.rend());
    const std::pair<double, double> cases[] = {{0.1, 1.281552}, {0.75, -0.674490}};
    for (const auto& [fraction, u] : cases) {
        const auto piece = coatedWith([&](double x, double y) { return sigma * field(x, y); });
        const LayerVolume before = piece->volume->clone();
        auto work = piece->work();
        AreaPolish what;
        what.fraction = fraction;
        const OperationReport report = polishArea(work, what, piece->progress);
        ASSERT_TRUE(report.heightUm);
        EXPECT_NEAR(*report.heightUm, heights[std::size_t(fraction * heights.size())], 0.005) << fraction;
        EXPECT_NEAR(*report.heightUm, 1.0 + sigma * u, 0.25 * sigma) << fraction;
        EXPECT_NEAR(areaHigherThan(before, *report.heightUm), fraction, 0.005) << fraction;
        expectCutAt(*report.heightUm, before, *piece->volume);
    }
}

TEST(PolishArea, NoneChangesNothingAndAllLevelsToTheLowestPlace) {
    const auto piece = coatedWith([&](double x, double) { return 0.4 * std::sin(2.0 * M_PI * x / 30.0); });
    const std::string before = contentHash(*piece->volume);
    auto work = piece->work();
    AreaPolish what;
    what.fraction = 0.0;
    polishArea(work, what, piece->progress);
    EXPECT_EQ(contentHash(*piece->volume), before);
    what.fraction = 1.0;
    polishArea(work, what, piece->progress);
    EXPECT_NEAR(meanHeight(*piece->volume), 0.6, 0.02);
}

TEST(PolishArea, WhereTheMapIsNothingThereIsNoPlateau) {
    const auto piece = coatedWith([&](double x, double) { return 0.4 * std::sin(2.0 * M_PI * x / 30.0); });
    const test::FunctionMap half([](const MapPoint& point) { return point.position.y < size / 2 ? 1.0 : 0.0; });
    auto work = piece->work();
    AreaPolish what;
    what.fraction = 0.25;
    what.map = &half;
    const OperationReport report = polishArea(work, what, piece->progress);
    // A quarter of the whole is half of the half that may be polished: its middle height.
    EXPECT_NEAR(report.heightUm.value_or(0.0), 1.0, 0.02);
    const test::Column column(*piece->volume, flat);
    EXPECT_NEAR(column.height(7.5, 20.0), 1.0, 0.02);
    EXPECT_NEAR(column.height(7.5, 70.0), 1.4, 0.02);
    EXPECT_NEAR(column.height(22.5, 20.0), 0.6, 0.02);
}

TEST(PolishArea, TheMapMultipliesTheDepthRemoved) {
    const auto piece = coatedWith([&](double x, double) { return 0.4 * std::sin(2.0 * M_PI * x / 30.0); });
    const test::FunctionMap half([](const MapPoint&) { return 0.5; });
    auto work = piece->work();
    AreaPolish what;
    what.fraction = 0.25;
    what.map = &half;
    // Each place counts half: the height of half the area.
    const OperationReport report = polishArea(work, what, piece->progress);
    EXPECT_NEAR(report.heightUm.value_or(0.0), 1.0, 0.02);
    EXPECT_NEAR(test::Column(*piece->volume, flat).height(7.5, 20.0), 1.2, 0.02);
}

TEST(PolishArea, AWindowFollowsASlowSlope) {
    // A ripple on a ramp that is ten times as high: one height for all would take the high end only.
    const auto piece = test::makePiece(test::sheet(float(size), 90), test::voxelScale(), 10.0);
    const auto height = [](double x) { return 1.0 + 3.0 * x / size + 0.2 * std::sin(2.0 * M_PI * x / 10.0); };
    const test::FunctionMap map([&](const MapPoint& point) { return height(point.position.x) / 5.0; });
    auto work = piece->work();
    coat(work, "soot", 5.0, &map, piece->progress);
    const LayerVolume before = piece->volume->clone();
    AreaPolish what;
    what.fraction = 0.5;
    what.window = 15.0;
    polishArea(work, what, piece->progress);
    const test::Column now(*piece->volume, flat), then(before, flat);
    for (double x = 25.0; x < 65.0; x += 10.0) {
        const double end = x + 10.0;
        double polished = 0.0;
        for (int i = 0; i < 200; ++i)
            polished +=
                then.height(x + (end - x) * i / 200.0, 45.0) - now.height(x + (end - x) * i / 200.0, 45.0) > 1e-3;
        EXPECT_NEAR(polished / 200.0, 0.5, 0.12) << x;
    }
}

TEST(PolishArea, OfAMaterialGoesOnUntilItShowsOnTheFraction) {
    // Soot of 0.5 everywhere under dirt of 0 … 1: cut at c the soot shows where the dirt was … everywhere at 0.5,
    // nowhere above: at the first height that shows it at all. Under a wavy soot the fraction is its own Abbott curve.
    const auto piece = test::makePiece(test::sheet(float(size), 90), test::voxelScale(), 7.0);
    const test::FunctionMap map(
        [](const MapPoint& point) { return 0.5 + 0.4 * std::sin(2.0 * M_PI * point.position.x / 30.0); });
    auto work = piece->work();
    coat(work, "soot", 1.0, &map, piece->progress);
    coat(work, "dirt", 0.5, nullptr, piece->progress);
    AreaPolish what;
    what.fraction = 0.3;
    what.ofMaterial = "soot";
    const OperationReport report = polishArea(work, what, piece->progress);
    EXPECT_NEAR(report.heightUm.value_or(0.0), 0.5 + 0.4 * std::cos(M_PI * 0.3), 0.02);
    EXPECT_NEAR(report.fraction.value_or(0.0), 0.3, 0.001);
    const StackStatistics stack = measureStack(*piece->volume, piece->surface);
    EXPECT_NEAR(stack.layers[1].coverage, 0.7, 0.05); // the edges of the dirt are as sharp as a voxel
}

TEST(PolishArea, MeasuresHeightsAsThicknessesBesideSharpEdges) {
    // Even films over roofs of 45 degrees: up from a valley's bottom a line is 1.4 times as long as they are thick.
    // Half the depth is removed, so the soot shows where the cut lies as far below it as the dirt is thick.
    const auto roofs = [](double x, double) { return std::abs(std::fmod(x, 10.0) - 5.0); };
    const auto piece = test::makePiece(test::relief(60.f, 120, roofs), test::voxelScale(), 7.0);
    auto work = piece->work();
    coat(work, "soot", 0.4, nullptr, piece->progress);
    coat(work, "dirt", 0.25, nullptr, piece->progress);
    const test::FunctionMap half([](const MapPoint&) { return 0.5; });
    AreaPolish what;
    what.fraction = 0.95;
    what.ofMaterial = "soot";
    what.map = &half;
    const OperationReport report = polishArea(work, what, piece->progress);
    EXPECT_NEAR(report.heightUm.value_or(0.0), 0.4 - 0.25, 0.02);
    EXPECT_GE(report.fraction.value_or(0.0), 0.95);
    const StackStatistics stack = measureStack(*piece->volume, piece->surface);
    EXPECT_NEAR(stack.total.meanUm, 0.4, 0.02);
}

TEST(PolishArea, OfAMaterialThatShowsAlreadyOrNeverWillTakesNothing) {
    const auto piece = coatedWith([&](double x, double) { return 0.4 * std::sin(2.0 * M_PI * x / 30.0); });
    const std::string before = contentHash(*piece->volume);
    auto work = piece->work();
    AreaPolish what;
    what.fraction = 0.3;
    for (const char* material : {"soot", "wax"}) {
        what.ofMaterial = material;
        polishArea(work, what, piece->progress);
        EXPECT_EQ(contentHash(*piece->volume), before) << material;
    }
}

TEST(EvenSamples, LieInProportionToTheArea) {
    SurfaceMesh surface = test::sheet(1.f, 1);
    surface.positions[3].x = 3.f; // one triangle thrice as large
    const auto points = evenSamples(surface, 40000);
    double first = 0.0, u = 0.0;
    for (const SurfacePoint& p : points) {
        ASSERT_LE(p.u + p.v, 1.f + 1e-6f);
        first += p.triangle == 0;
        u += p.u;
    }
    const Imath::V3i& t = surface.triangles[0];
    const auto area = [&](const Imath::V3i& c) {
        return 0.5 * (surface.positions[c[1]] - surface.positions[c[0]])
                         .cross(surface.positions[c[2]] - surface.positions[c[0]])
                         .length();
    };
    const double share = area(t) / (area(t) + area(surface.triangles[1]));
    EXPECT_NEAR(first / 40000.0, share, 1e-3);
    EXPECT_NEAR(u / 40000.0, 1.0 / 3.0, 1e-3);
}

} // namespace
} // namespace patina
