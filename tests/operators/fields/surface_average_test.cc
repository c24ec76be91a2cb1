#include "operators/fields/surface_average.h"

#include "field_test_shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3d;

/// What is left of a wave on a plane that no lattice plane lies along: the wave fitted to the result, over the first.
double leftOfAWave(double length, double deviation, double& remainder) {
    const auto plane = test::volumeOf([](const V3d& p) { return p.z; }, 40);
    const SurfaceVoxels surface = findSurfaceVoxels(*plane, 0);
    std::vector<float> values, wave;
    for (const Imath::V3f& foot : surface.feet) {
        wave.push_back(float(std::cos(2.0 * M_PI * test::toObject(V3d(foot)).x / length)));
        values.push_back(0.5f + 0.5f * wave.back());
    }
    Progress progress;
    const std::vector<float> mean = surfaceAverage(surface, values, deviation, progress);
    double product = 0.0, square = 0.0;
    const auto visit = [&](auto&& use) {
        for (std::size_t i = 0; i < surface.size(); ++i) {
            const V3d p = test::toObject(V3d(surface.feet[i]));
            if (std::max(std::abs(p.x), std::abs(p.y)) < 20.0) // the plane's rim is far away
                use(double(wave[i]), 2.0 * mean[i] - 1.0);
        }
    };
    visit([&](double first, double now) {
        product += first * now;
        square += first * first;
    });
    const double left = product / square;
    remainder = 0.0;
    visit([&](double first, double now) { remainder = std::max(remainder, std::abs(now - left * first)); });
    return left;
}

TEST(SurfaceAverage, AWaveOnAPlaneIsDampedAsByAGaussian) {
    for (const double deviation : {1.0, 2.0, 4.0})
        for (const double length : {20.0, 40.0}) {
            double remainder = 0.0;
            const double left = leftOfAWave(length, deviation, remainder);
            EXPECT_NEAR(left, std::exp(-2.0 * std::pow(M_PI * deviation / length, 2.0)), 0.02)
                << deviation << " " << length;
            EXPECT_LT(remainder, 0.1) << deviation << " " << length;
        }
    double remainder = 0.0;
    EXPECT_NEAR(leftOfAWave(20.0, 0.0, remainder), 1.0, 1e-6);
}

// Two sheets of metal with a gap of two voxels and a half between: what is on one is not seen on the other.
TEST(SurfaceAverage, SheetsThatFaceEachOtherKeepApart) {
    const auto gap = test::volumeOf([](const V3d& p) { return 1.25 - std::abs(p.z); }, 20);
    const SurfaceVoxels surface = findSurfaceVoxels(*gap, 0);
    std::vector<float> values;
    for (const Imath::V3f& normal : surface.normals)
        values.push_back(test::toObject(V3d(normal)).z > 0.0 ? 1.f : 0.f);
    Progress progress;
    const std::vector<float> mean = surfaceAverage(surface, values, 2.0, progress);
    for (std::size_t i = 0; i < surface.size(); ++i)
        if (test::toObject(V3d(surface.feet[i])).length() < 10.0) { // the sheets' ends are far away
            ASSERT_NEAR(mean[i], values[i], 1e-3) << i;
        }
}

} // namespace
} // namespace patina
