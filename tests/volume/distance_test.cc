#include "volume/distance.h"

#include "support/exact_volume.h"
#include "support/on_threads.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

struct Error {
    double rms = 0.0, largest = 0.0;
    double rmsOutside = 0.0; ///< of voxels a voxel or more outside
};

Error errorOf(const LayerVolume& volume, const test::Distance& truth) {
    Progress progress;
    const DistanceField field = distanceToInterface(volume, 0, {}, progress);
    double sum = 0.0, outside = 0.0, count = 0.0;
    Error error;
    std::size_t at = 0;
    for (const FloatLeaf* leaf : leavesOf(std::as_const(volume.grids().base->tree())))
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            const double e = field.distance[at] - truth(volume.grids().space.position(c));
            sum += e * e;
            if (field.distance[at] > 1.f) {
                outside += e * e;
                count += 1.0;
            }
            error.largest = std::max(error.largest, std::abs(e));
        }
    error.rms = std::sqrt(sum / double(at));
    error.rmsOutside = std::sqrt(outside / count);
    return error;
}

TEST(Distance, IsGoodToAThousandthOfAVoxelOnRoundBodies) {
    for (const double radius : {10.0, 25.0}) {
        const auto truth = [radius](const Imath::V3d& p) { return (p - Imath::V3d(.31, .17, -.23)).length() - radius; };
        const Error error = errorOf(test::volumeOf(truth, int(radius) + 14, 5.0, 12.0), truth);
        EXPECT_LT(error.rms, 0.001) << radius;
        EXPECT_LT(error.largest, 0.005) << radius;
    }
    const auto torus = [](const Imath::V3d& p) { return test::torusDistance(test::turned(p, 0.4), 24.0, 10.0); };
    EXPECT_LT(errorOf(test::volumeOf(torus, 44, 5.0, 8.0), torus).rms, 0.001);
}

TEST(Distance, IsGoodToAFewHundredthsAroundSharpEdges) {
    for (const double turn : {0.0, 0.3, 0.7}) {
        const auto truth = [turn](const Imath::V3d& p) {
            return test::boxDistance(test::turned(p + Imath::V3d(0.31, 0.17, 0.42), turn), {20.0, 15.0, 10.0});
        };
        EXPECT_LT(errorOf(test::volumeOf(truth, 42, 5.0, 12.0), truth).rmsOutside, 0.02) << turn;
    }
}

TEST(Distance, FeetLieOnTheSurface) {
    const auto truth = [](const Imath::V3d& p) { return (p - Imath::V3d(.31, .17, -.23)).length() - 15.0; };
    const LayerVolume volume = test::volumeOf(truth, 26, 5.0, 9.0);
    Progress progress;
    DistanceOptions options;
    options.feet = true;
    const DistanceField field = distanceToInterface(volume, 0, options, progress);
    std::size_t at = 0;
    for (const FloatLeaf* leaf : leavesOf(std::as_const(volume.grids().base->tree())))
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            ASSERT_NEAR(truth(volume.grids().space.position(c) + Imath::V3d(field.toFoot[at])), 0.0, 0.005);
        }
}

TEST(Distance, HasTheSameBitsOnAnyNumberOfThreads) {
    const LayerVolume volume = test::volumeOf(
        [](const Imath::V3d& p) { return test::boxDistance(test::turned(p, 0.3), {14.0, 9.0, 11.0}); }, 26, 4.0, 7.0);
    Progress progress;
    std::vector<std::vector<float>> results;
    for (const std::size_t threads : {1, 2, 4})
        test::onThreads(threads, [&] {
            results.push_back(distanceToInterface(volume, 0, {}, progress).distance);
        });
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

} // namespace
} // namespace patina
