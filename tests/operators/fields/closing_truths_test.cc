// Accessibility by its other version: a closing by a ball of radius r leaves a place alone exactly where the largest
// sphere that touches it is at least r. The shapes whose spheres have closed forms, at every surface voxel.

#include "field_test_shapes.h"
#include "operators/fields/surface_voxels.h"
#include "support/closed_levels.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina {
namespace {

using Imath::V3d;

/// Closes by r and counts the surface voxels whose sphere, where it is not negative, is smaller than r by more than
/// half a voxel and 1 % and whose level is left alone bit for bit, or larger by as much and not left alone.
int wrong(const LayerVolume& volume, double r, const std::function<double(const V3d&)>& truth, bool global = false) {
    Progress progress;
    const SurfaceVoxels surface = findSurfaceVoxels(volume, 0);
    ClosingOptions options;
    options.radius = r;
    options.global = global;
    const test::ClosedLevels closed(volume, options, progress);
    int found = 0, smaller = 0, larger = 0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const V3d p = test::toObject(V3d(surface.feet[i]));
        const double expected = truth(p);
        if (expected < 0.0 || std::abs(expected - r) <= std::max(0.5, 0.01 * r))
            continue;
        const float filled = closed.filled(surface.voxels[i]);
        const bool alone = filled == 0.f;
        (expected < r ? smaller : larger) += 1;
        if (alone != (expected > r) && ++found < 4)
            ADD_FAILURE() << "r " << r << ", truth " << expected << " at " << p << (alone ? ": alone" : ": filled by ")
                          << filled;
    }
    EXPECT_GT(smaller + larger, 300) << r;
    return found;
}

TEST(ClosingTruths, APlaneABallAndTheInsideOfASphere) {
    const auto plane = test::volumeOf([](const V3d& p) { return p.z; }, 30);
    EXPECT_EQ(wrong(*plane, 8.0,
                    [](const V3d& p) {
                        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 12.0 ? 1e3 : -1.0;
                    }),
              0);
    const auto ball = test::volumeOf([](const V3d& p) { return p.length() - 20.0; }, 30);
    EXPECT_EQ(wrong(*ball, 8.0, [](const V3d&) { return 1e3; }), 0);
    for (const double radius : {6.0, 14.0}) {
        const auto hollow = test::volumeOf([=](const V3d& p) { return radius - p.length(); }, 26);
        for (const double r : {radius - 0.51, radius + 0.51})
            EXPECT_EQ(wrong(*hollow, r, [=](const V3d&) { return radius; }), 0) << radius;
    }
}

TEST(ClosingTruths, AGap) {
    for (const double width : {6.0, 15.3}) {
        const auto gap = test::volumeOf([=](const V3d& p) { return 0.5 * width - std::abs(p.z); }, 34);
        for (const double r : {0.5 * width - 0.51, 0.5 * width + 0.51})
            EXPECT_EQ(
                wrong(*gap, r,
                      [=](const V3d& p) { return std::max(std::abs(p.x), std::abs(p.y)) < 14.0 ? 0.5 * width : -1.0; }),
                0)
                << width;
    }
}

TEST(ClosingTruths, WallsOfAGroove) {
    for (const double degrees : {30.0, 45.0, 60.0}) {
        const double half = degrees * M_PI / 180.0;
        const auto groove = test::volumeOf(test::groove(half), 44);
        for (const double r : {2.5, 5.0, 9.0})
            EXPECT_EQ(wrong(*groove, r,
                            [=](const V3d& p) {
                                const double s = std::hypot(p.x, p.z);
                                return std::abs(p.y) < 16.0 && s < 24.0 ? s * std::tan(half) : -1.0;
                            }),
                      0)
                << degrees;
    }
}

TEST(ClosingTruths, ACornerOfThreeFaces) {
    const auto corner = test::volumeOf([](const V3d& p) { return std::min({p.x, p.y, p.z}); }, 44);
    for (const double r : {3.0, 7.0})
        EXPECT_EQ(wrong(*corner, r,
                        [](const V3d& p) {
                            double c[3] = {p.x, p.y, p.z};
                            std::sort(c, c + 3);
                            return c[2] < 20.0 ? std::max(0.0, c[1]) : -1.0;
                        }),
                  0);
}

TEST(ClosingTruths, FloorAndWallsOfASlot) {
    const double w = 16.0;
    for (const double d : {6.0, 14.0}) {
        const auto slot = test::volumeOf(test::slot(w, d), 40);
        for (const double r : {3.0, 5.0, 7.3, 9.0})
            EXPECT_EQ(wrong(*slot, r, [=](const V3d& p) { return test::slotRadius(w, d, p); }), 0) << d;
    }
}

TEST(ClosingTruths, FloorOfAWell) {
    const double radius = 12.0, d = 7.0;
    const auto well = test::volumeOf(
        [=](const V3d& p) { return std::max(p.z, -std::max(std::hypot(p.x, p.y) - radius, -d - p.z)); }, 36);
    for (const double r : {3.0, 6.0, 9.0})
        EXPECT_EQ(wrong(*well, r,
                        [=](const V3d& p) {
                            const double x0 = radius - std::hypot(p.x, p.y);
                            if (p.z > -d + 0.3 || x0 < 0.5)
                                return -1.0;
                            return x0 <= d ? x0 : (x0 * x0 + d * d) / (2.0 * d);
                        }),
                  0);
}

TEST(ClosingTruths, OfABottleOnlyWhatCanComeThroughTheNeck) {
    const auto bottle = test::volumeOf(test::bottle(), 42);
    const auto inCavity = [](const V3d& p, double value) {
        return std::abs(p.length() - 14.0) < 0.2 && p.z < 8.0 ? value : -1.0;
    };
    for (const double r : {8.0, 13.4, 14.6})
        EXPECT_EQ(wrong(*bottle, r, [&](const V3d& p) { return inCavity(p, 14.0); }), 0);
    for (const double r : {4.4, 5.6, 8.0})
        EXPECT_EQ(wrong(
                      *bottle, r, [&](const V3d& p) { return inCavity(p, 5.0); }, true),
                  0);
}

} // namespace
} // namespace patina
