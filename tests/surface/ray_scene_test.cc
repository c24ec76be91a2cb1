#include "surface/ray_scene.h"

#include "base/random.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "test_models.h"

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

SurfaceMesh plainCube() {
    LimitSurfaceOptions options;
    options.scheme = SubdivisionScheme::none;
    return makeLimitSurface(makeCube(), options);
}

/// The triangle's minimum by search over its interior and edges: nothing in common with the code tested.
double bruteForceDistance(const V3d& p, const V3d& a, const V3d& b, const V3d& c) {
    const V3d normal = (b - a).cross(c - a);
    double best = 1e300;
    const V3d corners[3] = {a, b, c};
    bool inside = normal.length() > 0.0;
    for (int i = 0; i < 3; ++i) {
        const V3d &from = corners[i], &to = corners[(i + 1) % 3];
        const double length2 = (to - from).length2();
        const double t = length2 > 0.0 ? std::clamp((p - from).dot(to - from) / length2, 0.0, 1.0) : 0.0;
        best = std::min(best, (p - from - t * (to - from)).length());
        inside = inside && normal.cross(to - from).dot(p - from) >= 0.0;
    }
    if (inside)
        best = std::min(best, std::abs((p - a).dot(normal)) / normal.length());
    return best;
}

TEST(RayScene, hitsTheNearestFaceOutsideIn) {
    const SurfaceMesh cube = plainCube();
    const RayScene scene(cube.positions, cube.triangles);
    const auto hit = scene.intersect(V3f(5, 0.25f, 0.5f), V3f(-1, 0, 0));
    ASSERT_TRUE(hit);
    EXPECT_FLOAT_EQ(hit->distance, 4.f);
    EXPECT_LT((hit->geometricNormal.normalized() - V3f(1, 0, 0)).length(), 1e-6f);
    const V3d at = positionAt(cube, hit->point);
    EXPECT_LT((at - V3d(1, 0.25, 0.5)).length(), 1e-6);
    EXPECT_FALSE(scene.intersect(V3f(5, 0.25f, 0.5f), V3f(-1, 0, 0), 0.f, 3.9f));
    EXPECT_FALSE(scene.intersect(V3f(5, 0.25f, 0.5f), V3f(1, 0, 0)));
    EXPECT_TRUE(scene.occluded(V3f(5, 0, 0.5f), V3f(-1, 0, 0), 0.f, 4.5f));
    EXPECT_FALSE(scene.occluded(V3f(5, 0, 0.5f), V3f(-1, 0, 0), 0.f, 3.5f));
    const auto face = scene.firstFace(V3f(5, 0.25f, 0.5f), V3f(-1, 0, 0), 10.f);
    ASSERT_TRUE(face);
    EXPECT_FLOAT_EQ(face->distance, 4.f);
    EXPECT_LT((face->normal - V3f(1, 0, 0)).length(), 1e-6f);
    EXPECT_NEAR(face->width, std::sqrt(2.0), 1e-6); // half of a square of side 2, over its diagonal
    EXPECT_FALSE(scene.firstFace(V3f(5, 0.25f, 0.5f), V3f(-1, 0, 0), 3.9f));
    // nearest skips what lies before it: the far side, from within.
    const auto far = scene.intersect(V3f(5, 0.25f, 0.5f), V3f(-1, 0, 0), 4.5f);
    ASSERT_TRUE(far);
    EXPECT_FLOAT_EQ(far->distance, 6.f);
}

TEST(RayScene, raysThroughASharedEdgeTakeTheSmallerTriangle) {
    // The same sheet with its triangles in any order: on the diagonal it is always the smaller index.
    const std::vector<V3f> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    for (const std::vector<V3i>& triangles :
         {std::vector<V3i>{{0, 1, 2}, {0, 2, 3}}, std::vector<V3i>{{0, 2, 3}, {0, 1, 2}}}) {
        const RayScene scene(positions, triangles);
        for (const float at : {0.25f, 0.5f, 0.75f}) {
            const auto hit = scene.intersect(V3f(at, at, 1), V3f(0, 0, -1));
            ASSERT_TRUE(hit) << "watertight";
            EXPECT_EQ(hit->point.triangle, 0);
        }
    }
}

TEST(RayScene, batchesMeetWhatSingleRaysMeet) {
    const SurfaceMesh cube = plainCube();
    const RayScene scene(cube.positions, cube.triangles);
    const KeyedRandom random(2, "packets", "test");
    RayBatch batch;
    HitBatch hits;
    std::vector<char> blocked;
    for (const int count : {1, 15, 16, 17, 300, 1000}) {
        batch.count = 0;
        for (int i = 0; i < count; ++i) {
            const auto r = random.uniforms(std::uint32_t(count), i, 0, 0),
                       s = random.uniforms(std::uint32_t(count), i, 1, 0);
            batch.add(V3f(float(6 * r[0] - 3), float(6 * r[1] - 3), float(6 * r[2] - 3)),
                      V3f(float(s[0] - 0.5), float(s[1] - 0.5), float(s[2] - 0.5)), i % 3 == 0 ? 2.f : 1e9f);
        }
        scene.intersect(batch, count % 2 == 0, hits);
        scene.occluded(batch, blocked);
        for (std::size_t i = 0; i < batch.count; ++i) {
            const V3f origin = batch.origin[i], direction = batch.direction[i];
            const auto one = scene.intersect(origin, direction, 0.f, batch.farthest[i]);
            ASSERT_EQ(hits.triangle[i] >= 0, bool(one));
            EXPECT_EQ(bool(blocked[i]), scene.occluded(origin, direction, 0.f, batch.farthest[i]));
            if (one) {
                EXPECT_EQ(hits.triangle[i], one->point.triangle);
                EXPECT_NEAR(hits.distance[i], one->distance, 1e-5f * one->distance);
                EXPECT_NEAR(hits.u[i], one->point.u, 1e-5f);
            }
        }
    }
}

TEST(RayScene, closestFacingPassesOverTheNearerSideOfAGap) {
    // The lower triangle faces up, the upper one, half a unit above it, down.
    const RayScene scene(
        {V3f(-1, -1, 0), V3f(1, -1, 0), V3f(0, 1, 0), V3f(-1, -1, 0.5f), V3f(1, -1, 0.5f), V3f(0, 1, 0.5f)},
        {V3i(0, 1, 2), V3i(3, 5, 4)});
    const V3f point(0.f, 0.f, 0.4f), up(0.f, 0.f, 1.f);
    EXPECT_EQ(scene.closest(point)->point.triangle, 1);
    EXPECT_EQ(scene.closestFacing(point, -up, 1.f)->point.triangle, 1);
    const auto lower = scene.closestFacing(point, up * 3.f, 1.f);
    ASSERT_TRUE(lower);
    EXPECT_EQ(lower->point.triangle, 0);
    EXPECT_FLOAT_EQ(lower->distance, 0.4f);
    EXPECT_FALSE(scene.closestFacing(point, up, 0.3f));
    EXPECT_FALSE(scene.closestFacing(point, V3f(1.f, 0.f, 0.f), 1.f));
    EXPECT_FALSE(scene.closestFacing(point, up, 1.f, V3f(0.f, 0.28f, 0.96f))); // 16 degrees
    EXPECT_TRUE(scene.closestFacing(point, up, 1.f, V3f(0.f, 0.8f, 0.6f)));    // 53 degrees
}

TEST(RayScene, closestPointMatchesBruteForce) {
    PATINA_NEEDS_MODEL("suzanne.obj");
    const SurfaceMesh surface =
        makeLimitSurface(readMesh(sharedModel("suzanne.obj")), {SubdivisionScheme::none, -1, 0});
    const RayScene scene(surface.positions, surface.triangles);
    const KeyedRandom random(1, "closest", "test");
    for (int i = 0; i < 1500; ++i) {
        const auto r = random.uniforms(0, i, 0, 0);
        const V3f point(static_cast<float>(4 * r[0] - 2), static_cast<float>(4 * r[1] - 2),
                        static_cast<float>(4 * r[2] - 2));
        double expected = 1e300;
        for (const V3i& t : surface.triangles)
            expected = std::min(expected, bruteForceDistance(V3d(point), V3d(surface.positions[t.x]),
                                                             V3d(surface.positions[t.y]), V3d(surface.positions[t.z])));
        const auto closest = scene.closest(point);
        ASSERT_TRUE(closest);
        EXPECT_NEAR(closest->distance, expected, 1e-6 * (1.0 + expected));
        EXPECT_NEAR((positionAt(surface, closest->point) - V3d(point)).length(), expected, 2e-6);
        // Just inside and just outside the radius.
        const auto bound = static_cast<float>(expected);
        EXPECT_TRUE(scene.closest(point, bound * 1.0001f + 1e-6f));
        EXPECT_FALSE(scene.closest(point, bound * 0.9999f - 1e-6f));
    }
}

TEST(RayScene, tiesOfClosestGoToTheSmallestTriangle) {
    const SurfaceMesh cube = plainCube();
    const RayScene scene(cube.positions, cube.triangles);
    for (std::size_t vertex = 0; vertex < cube.positions.size(); ++vertex) {
        int smallest = -1;
        for (std::size_t i = 0; i < cube.triangles.size() && smallest < 0; ++i)
            for (int corner = 0; corner < 3; ++corner)
                if (cube.triangles[i][corner] == static_cast<int>(vertex))
                    smallest = static_cast<int>(i);
        const auto closest = scene.closest(2.f * cube.positions[vertex]);
        ASSERT_TRUE(closest);
        EXPECT_EQ(closest->point.triangle, smallest);
        EXPECT_FLOAT_EQ(closest->distance, std::sqrt(3.f));
    }
}

TEST(RayScene, degenerateTrianglesAndEmptyScenesAreHarmless) {
    const RayScene empty({}, {});
    EXPECT_FALSE(empty.intersect(V3f(0), V3f(0, 0, 1)));
    EXPECT_FALSE(empty.occluded(V3f(0), V3f(0, 0, 1), 0.f, 1.f));
    EXPECT_FALSE(empty.closest(V3f(0)));
    const std::vector<V3f> positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const RayScene needle(positions, {{0, 1, 2}, {1, 1, 1}});
    const auto closest = needle.closest(V3f(1.5f, 3, 4));
    ASSERT_TRUE(closest);
    EXPECT_FLOAT_EQ(closest->distance, 5.f);
    EXPECT_FALSE(needle.closest(V3f(std::nanf(""), 0, 0)));
}

} // namespace
} // namespace patina
