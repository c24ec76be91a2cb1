// DPD: the paper's patches, and Barabási and Stanley's pinned interfaces.

#include "operators/growth/grow.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace patina {
namespace {

bool patchCrosses(const GrowthLattice& plane, int side, double unblocked, std::uint64_t seed) {
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.step = options.total = 20000; // long enough for any path there is
    options.firstSeeds = options.seeding = options.blockedSpread = options.thickening = 0.0;
    options.blockedFraction = 1.0 - unblocked;
    options.seedCells = {side / 2 * side + side / 2};
    const auto height = growHeights(plane, options, seed, "crossing");
    for (int i = 0; i < side; ++i)
        if (height[i] > 0.f || height[(side - 1) * side + i] > 0.f || height[i * side] > 0.f ||
            height[i * side + side - 1] > 0.f)
            return true;
    return false;
}

TEST(DirectedPercolation, impassableBlocksStopPatchesAtTheSitePercolationThreshold) {
    constexpr int side = 512, runs = 8;
    const GrowthLattice plane = flatLattice(side, side, false);
    double sum = 0.0;
    for (std::uint64_t seed = 0; seed < runs; ++seed) {
        // A cell that is free at one fraction is free at every larger one, so each seed has one threshold.
        double low = 0.55, high = 0.63;
        while (high - low > 0.006) {
            const double middle = 0.5 * (low + high);
            (patchCrosses(plane, side, middle, seed) ? high : low) = middle;
        }
        sum += 0.5 * (low + high) / runs;
    }
    RecordProperty("threshold", std::to_string(sum));
    EXPECT_NEAR(sum, 0.593, 0.02);
}

TEST(DirectedPercolation, aSeedIsASquarePatch) {
    const GrowthLattice plane = flatLattice(64, 64, true);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.step = 0;
    options.total = 40;
    options.firstSeeds = options.seeding = 0.0;
    for (const int side : {1, 2, 5, 10}) {
        options.patch = side;
        options.seedCells = {0}; // across the periodic corner
        const auto height = growHeights(plane, options, 1, "patch");
        EXPECT_EQ(std::count(height.begin(), height.end(), 1.f), side * side);
        EXPECT_EQ(measureHeights(plane, height).patches, 1u);
    }
}

TEST(DirectedPercolation, patchesOnASphereAreAsWideInEveryDirection) {
    constexpr double radius = 120.0;
    const GrowthLattice ball = surfaceLattice(test::sphere(float(radius), 6), 1.0);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.firstSeeds = options.seeding = options.thickening = options.blockedFraction = 0.0;
    options.patch = 4;
    options.step = options.total = 12;
    // Patches in all the directions that a cube has of a kind: 6 faces, 12 edges, 8 corners.
    double sum[3] = {}, count[3] = {};
    for (int n = 0; n < 27; ++n) {
        const Imath::V3d direction(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
        const int kind = int(direction.length2() + 0.5) - 1;
        if (kind < 0)
            continue;
        int nearest = 0;
        for (std::size_t i = 0; i < ball.size(); ++i)
            if (Imath::V3d(ball.normals[i]).dot(direction) >
                Imath::V3d(ball.normals[std::size_t(nearest)]).dot(direction))
                nearest = int(i);
        options.seedCells = {nearest};
        const auto height = growHeights(ball, options, std::uint64_t(n), "patch");
        double area = 0.0;
        for (std::size_t i = 0; i < ball.size(); ++i)
            area += height[i] > 0.f ? ball.areas[i] : 0.0;
        sum[kind] += radius * std::acos(1.0 - area / (2.0 * M_PI * radius * radius)); // a cap's, in cells
        count[kind] += 1.0;
    }
    const double face = sum[0] / count[0], edge = sum[1] / count[1] / face, corner = sum[2] / count[2] / face;
    RecordProperty("radius", std::to_string(face));
    RecordProperty("edge", std::to_string(edge));
    RecordProperty("corner", std::to_string(corner));
    EXPECT_GT(face, 20.0);
    EXPECT_NEAR(edge, 1.0, 0.05);
    EXPECT_NEAR(corner, 1.0, 0.05);
}

TEST(DirectedPercolation, patchesSpreadFasterWhereFewerCellsAreBlocked) {
    // The paper's Figure 6: more cells are blocked in the upper half.
    const GrowthLattice plane = flatLattice(256, 256, true);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.step = 8;
    options.total = 40;
    for (std::size_t i = 0; i < plane.size(); ++i)
        options.blocked.push_back(i < plane.size() / 2 ? 0.75f : 0.35f);
    const auto height = growHeights(plane, options, 5, "figure 6");
    const auto covered = [&](std::size_t first) {
        return std::count_if(height.begin() + long(first), height.begin() + long(first + plane.size() / 2),
                             [](float h) { return h > 0.f; });
    };
    EXPECT_GT(covered(plane.size() / 2), 1.5 * double(covered(0)));
}

TEST(DirectedPercolation, isScatteredEarlyAndMostlyCoveredLate) {
    const GrowthLattice strip = flatLattice(512, 171, false);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.total = 40;
    options.step = 5;
    const GrowthStatistics early = grow(strip, options, 1, "strip").statistics;
    options.step = 20;
    const GrowthStatistics late = grow(strip, options, 1, "strip").statistics;
    EXPECT_GT(early.patches, 15u);
    EXPECT_GT(early.coverage, 0.05);
    EXPECT_LT(early.coverage, 0.3);
    EXPECT_GT(late.coverage, 0.7);
    EXPECT_LT(late.coverage, 0.97);
}

TEST(DirectedPercolation, upperLevelsAreNoLargerThanThoseThatBearThem) {
    const GrowthLattice plane = flatLattice(128, 128, true);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.step = options.total = 15;
    const auto height = growHeights(plane, options, 1, "levels");
    std::size_t below = plane.size();
    for (float level = 1; level < 12; ++level) {
        const auto area = std::size_t(std::count_if(height.begin(), height.end(), [=](float h) { return h >= level; }));
        EXPECT_LE(area, below);
        below = area;
    }
}

TEST(DirectedPercolation, cellsRiseInProportionToWhatSupportsThem) {
    // Square patches that do not spread: their corners have three supporters (themselves included), their sides four,
    // what is within them five. The chance to have risen after a time is 1 - exp(-thickening · supporters / 5 · time).
    constexpr int side = 512, pitch = 16, patch = 10;
    const GrowthLattice plane = flatLattice(side, side, true);
    GrowthOptions options;
    options.model = GrowthModel::directedPercolation;
    options.firstSeeds = options.seeding = options.spread = options.blockedSpread = 0.0;
    options.patch = patch;
    options.thickening = 0.8;
    options.step = options.total = 0.5;
    for (int y = pitch / 2; y < side; y += pitch)
        for (int x = pitch / 2; x < side; x += pitch)
            options.seedCells.push_back(y * side + x);
    const auto height = growHeights(plane, options, 2, "supporters");
    double risen[6] = {}, all[6] = {};
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const auto at = [&](int i, int j) {
                return height[std::size_t(((j + side) % side) * side + (i + side) % side)];
            };
            if (at(x, y) < 1.f)
                continue;
            const int supporters =
                1 + (at(x - 1, y) > 0.f) + (at(x + 1, y) > 0.f) + (at(x, y - 1) > 0.f) + (at(x, y + 1) > 0.f);
            all[supporters] += 1.0;
            risen[supporters] += at(x, y) > 1.f;
        }
    const double patches = double(options.seedCells.size());
    EXPECT_EQ(all[3], 4.0 * patches);
    EXPECT_EQ(all[4], 4.0 * (patch - 2) * patches);
    EXPECT_EQ(all[5], double((patch - 2) * (patch - 2)) * patches);
    for (const int n : {3, 4, 5}) {
        const double expected = 1.0 - std::exp(-0.8 * n / 5.0 * 0.5);
        EXPECT_NEAR(risen[n] / all[n], expected, 3.5 * std::sqrt(expected * (1.0 - expected) / all[n])) << n;
    }
}

bool moves(double blocked, std::uint64_t seed) {
    const GrowthLattice line = flatLattice(1024, 1, true);
    GrowthOptions options;
    options.model = GrowthModel::barabasiStanley;
    options.blockedFraction = blocked;
    options.step = options.total = 1500;
    const auto early = growHeights(line, options, seed, "pinning");
    options.step = options.total = 1550;
    return early != growHeights(line, options, seed, "pinning");
}

TEST(BarabasiStanley, interfacesPinAboveTheKnownFractionOfBlocks) {
    int movingBelow = 0, movingAbove = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        movingBelow += moves(0.46, seed);
        movingAbove += moves(0.48, seed);
    }
    RecordProperty("moving_at_0.46", movingBelow);
    EXPECT_GE(movingBelow, 4);
    EXPECT_EQ(movingAbove, 0);
}

} // namespace
} // namespace patina
