#include "render/camera.h"

#include "base/errors.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina {
namespace {

using Imath::V3f;

struct Extent {
    float left = 1e9f, right = -1e9f, top = 1e9f, bottom = -1e9f;
};

Extent extentOf(const Camera& camera, const std::vector<V3f>& points) {
    Extent e;
    for (const V3f& p : points) {
        const Imath::V2f q = camera.project(p);
        e.left = std::min(e.left, q.x), e.right = std::max(e.right, q.x);
        e.top = std::min(e.top, q.y), e.bottom = std::max(e.bottom, q.y);
    }
    return e;
}

std::vector<V3f> boxCorners(const Imath::Box3f& box) {
    std::vector<V3f> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back(
            {i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z});
    return corners;
}

TEST(Camera, fillsThePictureWithTheBoxAndCentresIt) {
    const Imath::Box3f box({3.f, -2.f, 0.f}, {3.2f, -1.7f, 0.9f});
    for (const UpAxis up : {UpAxis::y, UpAxis::z})
        for (const float azimuth : {-170.f, -30.f, 0.f, 45.f, 90.f})
            for (const float elevation : {-90.f, -20.f, 0.f, 15.f, 60.f, 90.f})
                for (const float aspect : {0.5f, 1.f, 1.78f}) {
                    CameraView view;
                    view.up = up, view.azimuthDegrees = azimuth, view.elevationDegrees = elevation, view.fill = 0.8f;
                    const Extent e = extentOf(Camera::framed(box, view, aspect), boxCorners(box));
                    EXPECT_NEAR(std::max(e.right - e.left, e.bottom - e.top), 0.8f, 1e-3f);
                    EXPECT_NEAR(e.left + e.right, 1.f, 0.15f);
                    EXPECT_GE(e.left, 0.0999f);
                    EXPECT_LE(e.right, 0.9001f);
                    EXPECT_GE(e.top, 0.0999f);
                    EXPECT_LE(e.bottom, 0.9001f);
                }
}

TEST(Camera, rayAndProjectionAgree) {
    CameraView view;
    view.azimuthDegrees = 33.f;
    const Camera camera = Camera::framed(Imath::Box3f(V3f(-1.f), V3f(1.f)), view, 1.5f);
    for (const float x : {0.1f, 0.5f, 0.8f})
        for (const float y : {0.2f, 0.5f, 0.95f}) {
            const CameraRay ray = camera.ray(x, y);
            EXPECT_NEAR(ray.direction.length(), 1.f, 1e-6f);
            const Imath::V2f back = camera.project(ray.origin + ray.direction * 7.f);
            EXPECT_NEAR(back.x, x, 1e-5f);
            EXPECT_NEAR(back.y, y, 1e-5f);
        }
}

TEST(Camera, ManyRaysAtOnceAreTheSame) {
    Camera camera = Camera::aimed({1, 2, 3}, 5.f, {}, 1.5f);
    const float x[3] = {0.1f, 0.5f, 1.f}, y[3] = {0.9f, 0.25f, 0.f}, u[3] = {0.2f, 0.9f, 0.f}, v[3] = {0.f, 0.3f, 0.7f};
    for (const float lens : {0.f, 0.3f}) {
        camera.setLens(lens, 4.f);
        CameraRays rays;
        camera.rays(x, y, u, v, 3, rays);
        for (std::size_t i = 0; i < 3; ++i) {
            const CameraRay one = camera.ray(x[i], y[i], {u[i], v[i]});
            EXPECT_EQ(rays.origin(i), one.origin);
            EXPECT_LT((rays.direction(i) - one.direction).length(), 1e-7f);
        }
    }
}

TEST(Camera, azimuthZeroSeesTheFrontAndUpIsUp) {
    const Imath::Box3f box(V3f(-1.f), V3f(1.f));
    CameraView view;
    view.elevationDegrees = 0.f;
    const Camera zUp = Camera::framed(box, view, 1.f);
    EXPECT_LT(zUp.position().y, -2.f);
    EXPECT_LT(zUp.project({0, 0, 0.5f}).y, zUp.project({0, 0, -0.5f}).y);
    EXPECT_GT(zUp.project({0.5f, 0, 0}).x, zUp.project({-0.5f, 0, 0}).x);
    view.up = UpAxis::y;
    const Camera yUp = Camera::framed(box, view, 1.f);
    EXPECT_GT(yUp.position().z, 2.f);
    EXPECT_LT(yUp.project({0, 0.5f, 0}).y, yUp.project({0, -0.5f, 0}).y);
    EXPECT_GT(yUp.project({0.5f, 0, 0}).x, yUp.project({-0.5f, 0, 0}).x);
}

TEST(Camera, automaticViewLooksAtTheFaceOfASheet) {
    const CameraView lying = automaticView(squareMesh(), UpAxis::z);
    EXPECT_GT(lying.elevationDegrees, 45.f);
    // The same square standing, with its face to -x.
    SurfaceMesh standing = squareMesh();
    for (V3f& p : standing.positions)
        p = {0.f, -p.y, p.x};
    for (auto& t : standing.triangles)
        std::swap(t.y, t.z);
    const V3f a = standing.positions[0], b = standing.positions[std::size_t(standing.triangles[0].y)],
              c = standing.positions[std::size_t(standing.triangles[0].z)];
    const V3f face = (b - a).cross(c - a).normalized();
    const Camera camera = Camera::framed(standing.positions, automaticView(standing, UpAxis::z), 1.f);
    EXPECT_GT((camera.position() - a) ^ face, 0.f);
    EXPECT_LT(automaticView(sphereMesh(16, 1.f), UpAxis::z).elevationDegrees, 20.f);
}

TEST(Camera, refusesWhatItCannotLookAt) {
    const Imath::Box3f box(V3f(-1.f), V3f(1.f));
    EXPECT_THROW(Camera::framed(Imath::Box3f(), CameraView{}, 1.f), RunError);
    EXPECT_THROW(Camera::framed(std::vector<V3f>{}, CameraView{}, 1.f), RunError);
    EXPECT_THROW(Camera::framed(std::vector<V3f>{V3f(NAN)}, CameraView{}, 1.f), RunError);
    EXPECT_THROW(Camera::framed(box, CameraView{}, 0.f), RunError);
    CameraView view;
    view.fieldOfViewDegrees = 180.f;
    EXPECT_THROW(Camera::framed(box, view, 1.f), RunError);
    view = {};
    view.elevationDegrees = 91.f;
    EXPECT_THROW(Camera::framed(box, view, 1.f), RunError);
}

} // namespace
} // namespace patina
