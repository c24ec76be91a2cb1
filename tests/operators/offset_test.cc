#include "operators/offset.h"

#include "base/errors.h"

#include "support/exact_volume.h"
#include "support/on_threads.h"
#include "volume/closing.h"

#include <gtest/gtest.h>

#include <map>

namespace patina {
namespace {

// Where the closed level set crosses zero on a line from `from` along z, going up.
double crossingAlongZ(const LayerVolume& volume, const std::vector<float>& level, int x, int y, int fromZ, int toZ) {
    std::map<int, float> column;
    std::size_t at = 0;
    for (const FloatLeaf* leaf : leavesOf(std::as_const(volume.grids().base->tree())))
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++at) {
            const Imath::V3i c = volume.grids().space.place(voxel.getCoord());
            if (c.x == x && c.y == y)
                column[c.z] = level[at];
        }
    for (int z = fromZ; z < toZ; ++z)
        if (column.count(z) && column.count(z + 1) && column[z] <= 0.f && column[z + 1] > 0.f)
            return z + double(column[z]) / (double(column[z]) - column[z + 1]);
    return 1e9;
}

TEST(Closing, TheApexOfAGrooveIsWhereTheBallEnds) {
    for (const double angle : {30.0, 45.0, 60.0})
        for (const double radius : {4.0, 8.0, 16.0}) {
            const double phi = angle * M_PI / 180.0;
            // Deep enough that the ball touches the walls: r cot(phi) along them.
            const double depth = radius * std::cos(phi) / std::tan(phi) + 6.0;
            const double width = depth * std::tan(phi);
            const Imath::V3d half(width + 12.0, 16.0, depth * 0.5 + 8.0);
            const double shift = 0.37;
            LayerVolume volume = test::volumeOf(
                [&](const Imath::V3d& p) {
                    return test::grooveDistance(p + Imath::V3d(0.0, 0.3, shift), half, depth, phi);
                },
                int(std::max({half.x, half.y, half.z})) + 6);
            Progress progress;
            ClosingOptions options;
            options.radius = radius;
            const Closing closing = closeInterface(volume, 0, options, progress);
            const double apex = half.z - depth - shift;
            const double expected = apex + radius * (1.0 / std::sin(phi) - 1.0);
            const double got = crossingAlongZ(volume, closing.level, 0, 0, int(std::floor(apex)) - 1, int(half.z) + 6);
            // The library's closing errs by 0.12 … 0.33 here.
            EXPECT_NEAR(got, expected, 0.05) << angle << " degrees, radius " << radius;
        }
}

std::size_t changedVoxels(LayerVolume volume, double radius) {
    Progress progress;
    ClosingOptions options;
    options.radius = radius;
    const Closing closing = closeInterface(volume, 0, options, progress);
    std::size_t at = 0, changed = 0;
    for (const FloatLeaf* leaf : leavesOf(std::as_const(volume.grids().base->tree())))
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++at) {
            changed += *voxel != closing.level[at];
        }
    EXPECT_EQ(closing.changed, changed > 0);
    return changed;
}

TEST(Closing, OfAConvexBodyChangesNoBit) {
    for (const double radius : {2.0, 5.0, 8.0, 16.0}) {
        EXPECT_EQ(
            changedVoxels(
                test::volumeOf([](const Imath::V3d& p) { return (p - Imath::V3d(0.3, 0.1, 0.2)).length() - 22.0; }, 28),
                radius),
            0u)
            << radius;
        EXPECT_EQ(changedVoxels(test::volumeOf(
                                    [](const Imath::V3d& p) {
                                        return test::boxDistance(p + Imath::V3d(0.31, 0.17, 0.42), {20.0, 15.0, 10.0});
                                    },
                                    26),
                                radius),
                  0u)
            << radius;
    }
}

TEST(Closing, OfATurnedBoxChangesNothingOfATenthOfAVoxel) {
    // Sharp edges across the lattice are known to some hundredths only.
    for (const double radius : {4.0, 8.0})
        for (const double turn : {0.3, 0.7}) {
            LayerVolume volume = test::volumeOf(
                [turn](const Imath::V3d& p) {
                    return test::boxDistance(test::turned(p + Imath::V3d(0.31, 0.17, 0.42), turn), {20.0, 15.0, 10.0});
                },
                32);
            Progress progress;
            ClosingOptions options;
            options.radius = radius;
            const Closing closing = closeInterface(volume, 0, options, progress);
            std::size_t at = 0;
            for (const FloatLeaf* leaf : leavesOf(std::as_const(volume.grids().base->tree())))
                for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++at)
                    if (std::abs(*voxel) < 1.f) {
                        ASSERT_LT(*voxel - closing.level[at], 0.1f) << radius << " turned by " << turn;
                    }
        }
}

TEST(Closing, OfATorusByABallThatFitsChangesNoBit) {
    for (const double radius : {4.0, 8.0, 13.0})
        EXPECT_EQ(
            changedVoxels(
                test::volumeOf(
                    [](const Imath::V3d& p) { return test::torusDistance(test::turned(p, 0.4), 25.0, 10.0); }, 40),
                radius),
            0u)
            << radius;
}

TEST(Closing, HasTheSameBitsOnAnyNumberOfThreads) {
    std::vector<std::vector<float>> results;
    for (const std::size_t threads : {1, 2, 4})
        test::onThreads(threads, [&] {
            LayerVolume volume = test::volumeOf(
                [](const Imath::V3d& p) { return test::torusDistance(test::turned(p, 0.4), 14.0, 8.0); }, 28);
            Progress progress;
            ClosingOptions options;
            options.radius = 8.0; // the hole's is 6
            results.push_back(closeInterface(volume, 0, options, progress).level);
        });
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

TEST(Closing, GlobalFillsAHoleThatNoBallCanLeave) {
    // A hollow sphere: balls fit inside, but cannot come from outside.
    const auto shell = [](const Imath::V3d& p) { return std::abs(p.length() - 20.0) - 5.0; };
    for (const bool global : {false, true}) {
        LayerVolume volume = test::volumeOf(shell, 32);
        Progress progress;
        ClosingOptions options;
        options.radius = 5.0;
        options.global = global;
        const Closing closing = closeInterface(volume, 0, options, progress);
        EXPECT_EQ(closing.changed, global);
    }
}

TEST(Offset, OfABallThatFitsAddsNoLayer) {
    const auto piece = test::makePiece(test::sphere(15.f, 4), test::voxelScale());
    const std::string before = contentHash(*piece->volume);
    Workpiece work = piece->work();
    const OperationReport report = offset(work, "wax", 6.0, false, piece->progress);
    EXPECT_EQ(piece->volume->layerCount(), 0);
    EXPECT_EQ(report.changedIds, 0u);
    EXPECT_EQ(contentHash(*piece->volume), before);
    EXPECT_THROW(offset(work, "wax", 0.0, false, piece->progress), Error);
}

} // namespace
} // namespace patina
