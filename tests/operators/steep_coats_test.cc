// Coat after coat by steep maps: each has its thickness along the normal of the surface that it was laid on.

#include "operators/coat.h"
#include "support/smooth_reader.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina {
namespace {

TEST(Coat, TenCoatsBySteepMapsAreMeasuredAlongTheCurrentNormal) {
    // A map of slope 0.5 (thickness per length), then what it lacks, in five directions: the surface is by turns wavy
    // with that slope and nearly even.
    constexpr double slope = 0.5, radius = 40.0;
    constexpr double thickness = 4.0;
    const auto piece = test::makePiece(test::sphere(float(radius), 6), test::voxelScale(), 5.0 * thickness + 6.0);
    Workpiece work = piece->work();
    for (int n = 0; n < 10; ++n) {
        const double angle = 0.4 + 0.6 * (n / 2), sign = n % 2 ? -1.0 : 1.0;
        const Imath::V3d axis = Imath::V3d(std::cos(angle), std::sin(angle), 0.5 * std::cos(3.0 * angle)).normalized();
        const auto factor = [&](const Imath::V3d& onBase) {
            return 0.5 + sign * 0.5 * std::sin(2.0 * slope / thickness * onBase.dot(axis));
        };
        const test::FunctionMap map([&](const MapPoint& point) { return factor(point.position); });
        const auto before = piece->volume->grids().surface().deepCopy();
        coat(work, "layer" + std::to_string(n), thickness, &map, piece->progress);
        const test::SmoothReader below(*before), above(piece->volume->grids().surface());
        std::vector<double> errors;
        double squares = 0.0, laid = 0.0, counted = 0.0, base = radius;
        for (std::size_t v = 0; v < piece->surface.positions.size(); v += 61) {
            const Imath::V3d direction = Imath::V3d(piece->surface.positions[v]).normalized();
            const double height = below.crossing(direction * base, direction, -0.5, 10.0 * thickness);
            const Imath::V3d p = below.ontoSurface(direction * (base + height));
            const double expected = thickness * factor(p.normalized() * radius);
            const double got = above.crossing(p, below.gradient(p).normalized(), -0.1, thickness + 1.0);
            ASSERT_TRUE(std::isfinite(got)) << "coat " << n;
            squares += std::pow(got - expected, 2);
            errors.push_back(std::abs(got - expected));
            laid += expected;
            counted += 1.0;
        }
        std::sort(errors.begin(), errors.end());
        const double rms = std::sqrt(squares / counted), median = errors[errors.size() / 2];
        RecordProperty("rms_" + std::to_string(n), std::to_string(rms));
        EXPECT_LT(rms, 0.01 * thickness) << "coat " << n;
        EXPECT_LT(median, 0.01 * laid / counted) << "coat " << n;
    }
}

} // namespace
} // namespace patina
