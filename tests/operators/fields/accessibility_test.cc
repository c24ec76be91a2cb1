#include "operators/fields/accessibility.h"

#include "base/progress.h"
#include "field_test_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina {
namespace {

using Imath::V3d;

struct Errors {
    double worst = 0.0;
    double beyondHalf = 0.0; ///< fraction of the points with an error of more than half a voxel
    int count = 0;
    V3d where;
};

/// Compares with a closed form wherever that is not negative, at the point of the shape next to each surface voxel: it
/// is that point's radius that the field holds. Errors in voxels, beyond 1 % of the truth.
Errors compare(const test::SignedDistance& shape, int extent, double limit,
               const std::function<double(const V3d&)>& truth, bool global = false) {
    Progress progress;
    const auto volume = test::volumeOf(shape, extent);
    const SurfaceVoxels surface = findSurfaceVoxels(*volume, 0);
    const auto radii = accessibleRadii(*volume, surface, 0, limit, global, progress);
    Errors errors;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const V3d p = test::closestPoint(shape, test::toObject(V3d(surface.voxels[i])));
        double expected = truth(p);
        if (expected < 0.0)
            continue;
        expected = std::min(expected, limit);
        const double error = std::max(0.0, std::abs(radii[i] - expected) - 0.01 * expected);
        if (error > errors.worst) {
            errors.worst = error;
            errors.where = p;
        }
        errors.beyondHalf += error > 0.5 ? 1.0 : 0.0;
        ++errors.count;
    }
    errors.beyondHalf /= std::max(1, errors.count);
    return errors;
}

bool inside(const V3d& p, double half) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < half;
}

TEST(Accessibility, APlaneAndAConvexBodyAreAsAccessibleAsAskedFor) {
    const test::SignedDistance plane = [](const V3d& p) { return p.z; };
    EXPECT_LT(compare(plane, 40, 30.0, [](const V3d& p) { return inside(p, 20.0) ? 30.0 : -1.0; }).worst, 1e-6);
    const test::SignedDistance ball = [](const V3d& p) { return p.length() - 25.0; };
    EXPECT_LT(compare(ball, 40, 30.0, [](const V3d&) { return 30.0; }).worst, 1e-6);
}

TEST(Accessibility, TheEdgesOfABoxAreAsAccessibleAsItsFaces) {
    const test::SignedDistance box = [](const V3d& p) {
        const V3d q(std::abs(p.x) - 20.0, std::abs(p.y) - 16.0, std::abs(p.z) - 12.0);
        const V3d out(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0));
        return out.length() + std::min(std::max({q.x, q.y, q.z}), 0.0);
    };
    // Where an edge was not found, or found by a little too far out, spheres beside it are stopped.
    const Errors errors = compare(box, 40, 20.0, [](const V3d&) { return 20.0; });
    EXPECT_LT(errors.beyondHalf, 0.001);
}

TEST(Accessibility, ASharpRimStopsNoSphereInABowlNorBesideIt) {
    const double radius = 14.0;
    for (const double depth : {4.0, 8.0}) {
        const auto hollow = [=](const V3d& p) {
            return radius - std::hypot(std::hypot(p.x, p.y), p.z - radius + depth);
        };
        const test::SignedDistance bowl = [=](const V3d& p) { return std::max(p.z, hollow(p)); };
        const Errors errors = compare(bowl, 40, 30.0, [=](const V3d& p) {
            if (std::abs(hollow(p)) < 0.05 && p.z < -0.5)
                return radius;
            return std::abs(p.z) < 0.2 && std::hypot(p.x, p.y) < 30.0 ? 30.0 : -1.0;
        });
        // On the rim itself a sphere may lean between the faces' normals: the largest stands on the plane. Those that
        // are stopped lie beside the rim, where normals lean by some hundredths.
        EXPECT_LT(errors.beyondHalf, 0.008) << depth;
        EXPECT_GT(errors.count, 2000);
    }
}

TEST(Accessibility, InsideASphereACylinderAndATorusItIsTheirRadius) {
    for (const double radius : {4.0, 9.5, 20.0}) {
        const test::SignedDistance sphere = [=](const V3d& p) { return radius - p.length(); };
        EXPECT_LT(compare(sphere, 36, 40.0, [=](const V3d&) { return radius; }).worst, 0.5) << radius;
        const test::SignedDistance cylinder = [=](const V3d& p) { return radius - std::hypot(p.x, p.z); };
        EXPECT_LT(compare(cylinder, 36, 40.0, [=](const V3d& p) { return std::abs(p.y) < 12.0 ? radius : -1.0; }).worst,
                  0.5)
            << radius;
    }
    const test::SignedDistance torus = [](const V3d& p) { return 7.0 - std::hypot(std::hypot(p.x, p.y) - 18.0, p.z); };
    EXPECT_LT(compare(torus, 30, 40.0, [](const V3d&) { return 7.0; }).worst, 0.5);
}

TEST(Accessibility, InAGapItIsHalfTheWidth) {
    for (const double width : {3.0, 10.3, 24.0}) {
        const test::SignedDistance gap = [=](const V3d& p) { return 0.5 * width - std::abs(p.z); };
        EXPECT_LT(compare(gap, 40, 40.0, [=](const V3d& p) { return inside(p, 20.0) ? 0.5 * width : -1.0; }).worst, 0.5)
            << width;
    }
}

TEST(Accessibility, OnTheWallsOfAGrooveItGrowsWithTheDistanceFromTheApex) {
    for (const double degrees : {30.0, 45.0, 60.0}) {
        const double half = degrees * M_PI / 180.0;
        const test::SignedDistance groove = test::groove(half);
        const Errors errors = compare(groove, 50, 16.0, [=](const V3d& p) {
            const double s = std::hypot(p.x, p.z);
            return std::abs(p.y) < 20.0 && s < 26.0 ? s * std::tan(half) : -1.0;
        });
        EXPECT_LT(errors.worst, 0.5) << degrees << " at " << errors.where.x << ' ' << errors.where.z;
        EXPECT_GT(errors.count, 1000);
    }
}

TEST(Accessibility, InACornerOfThreeFacesItIsTheDistanceToTheNearerWall) {
    const test::SignedDistance corner = [](const V3d& p) { return std::min({p.x, p.y, p.z}); };
    const Errors errors = compare(corner, 44, 12.0, [](const V3d& p) {
        const double size = std::max({p.x, p.y, p.z});
        // Of the three coordinates one is zero on a face; the ball is as large as the smaller of the others.
        double c[3] = {p.x, p.y, p.z};
        std::sort(c, c + 3);
        return size < 20.0 ? std::max(0.0, c[1]) : -1.0;
    });
    EXPECT_LT(errors.worst, 0.5) << errors.where.x << ' ' << errors.where.y << ' ' << errors.where.z;
}

TEST(Accessibility, InASlotFloorAndWallsAreAsTheClosedFormsSay) {
    const double w = 16.0;
    for (const double d : {6.0, 14.0}) {
        const test::SignedDistance slot = test::slot(w, d);
        const Errors errors = compare(slot, 40, 30.0, [=](const V3d& p) { return test::slotRadius(w, d, p); });
        EXPECT_LT(errors.worst, 0.5) << "depth " << d << " at " << errors.where.x << ' ' << errors.where.z;
    }
}

TEST(Accessibility, OnTheFloorOfAWellItIsThatOfASlot) {
    const double radius = 12.0, d = 7.0;
    const test::SignedDistance well = [=](const V3d& p) {
        return std::max(p.z, -std::max(std::hypot(p.x, p.y) - radius, -d - p.z));
    };
    const Errors errors = compare(well, 36, 30.0, [=](const V3d& p) {
        const double x0 = radius - std::hypot(p.x, p.y);
        if (p.z > -d + 0.3 || x0 < 0.5)
            return -1.0;
        return x0 <= d ? x0 : (x0 * x0 + d * d) / (2.0 * d);
    });
    EXPECT_LT(errors.worst, 0.5) << errors.where.x << ' ' << errors.where.y;
}

TEST(Accessibility, GlobalCountsOnlySpheresThatCanComeFromOutside) {
    const test::SignedDistance bottle = test::bottle();
    const auto inCavity = [](const V3d& p, double value) {
        return std::abs(p.length() - 14.0) < 0.2 && p.z < 8.0 ? value : -1.0;
    };
    EXPECT_LT(compare(bottle, 42, 20.0, [&](const V3d& p) { return inCavity(p, 14.0); }).worst, 0.5);
    const auto inFrontOfNeck = [&](const V3d& p) { return inCavity(p, 5.0); };
    EXPECT_LT(compare(bottle, 42, 20.0, inFrontOfNeck, true).worst, 0.5);
    // From outside nothing changes.
    const auto below = [](const V3d& p) { return p.z < -21.8 && std::hypot(p.x, p.y) < 15.0 ? 20.0 : -1.0; };
    EXPECT_LT(compare(bottle, 42, 20.0, below, true).worst, 1e-6);
}

TEST(Accessibility, IsTheSameWhateverTheNeighboursFound) {
    // Guesses from the voxel before only save time: one leaf alone gives what all leaves together give.
    const auto groove = test::volumeOf(test::groove(0.7), 24);
    Progress progress;
    const SurfaceVoxels surface = findSurfaceVoxels(*groove, 0);
    const auto once = accessibleRadii(*groove, surface, 0, 9.0, false, progress);
    const auto again = accessibleRadii(*groove, surface, 0, 9.0, false, progress);
    EXPECT_EQ(once, again);
}

} // namespace
} // namespace patina
