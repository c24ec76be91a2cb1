#include "render/displace.h"

#include "base/errors.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Imath::V3f;

TEST(Displaced, heightZeroKeepsEveryBit) {
    const SurfaceMesh sphere = sphereMesh(24, 2.f);
    const SurfaceMesh same = displaced(sphere, std::vector<float>(sphere.positions.size(), 0.f));
    EXPECT_EQ(same.positions, sphere.positions);
    EXPECT_EQ(same.normals, sphere.normals);
}

TEST(Displaced, anEvenCoatMakesALargerSphere) {
    const SurfaceMesh sphere = sphereMesh(24, 2.f);
    const SurfaceMesh coated = displaced(sphere, std::vector<float>(sphere.positions.size(), 0.5f));
    for (std::size_t i = 0; i < coated.positions.size(); ++i) {
        EXPECT_NEAR(coated.positions[i].length(), 2.5f, 1e-5f);
        EXPECT_NEAR((coated.normals[i] - sphere.normals[i]).length(), 0.f, 1e-5f);
    }
}

TEST(Displaced, aSlopeTiltsTheNormals) {
    // A fine square with height 0.3 x: normal (-0.3, 0, 1) / sqrt(1.09) everywhere.
    SurfaceMesh mesh;
    constexpr int n = 8;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x)
            mesh.positions.push_back({float(x), float(y), 0.f});
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int a = y * (n + 1) + x;
            mesh.triangles.push_back({a, a + 1, a + n + 2});
            mesh.triangles.push_back({a, a + n + 2, a + n + 1});
        }
    std::vector<float> heights;
    for (const V3f& p : mesh.positions)
        heights.push_back(0.3f * p.x);
    const V3f expected = V3f(-0.3f, 0.f, 1.f).normalized();
    for (const V3f& normal : displaced(mesh, heights).normals)
        EXPECT_NEAR((normal - expected).length(), 0.f, 1e-5f);
}

TEST(Displaced, seamsOfSplitVerticesStayShut) {
    SurfaceMesh mesh = squareMesh();
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, 1, 0}};
    mesh.normals.assign(6, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {4, 5, 3}};
    const SurfaceMesh moved = displaced(mesh, {1.f, 0.f, 0.2f, 0.f, 3.f, 0.4f});
    EXPECT_EQ(moved.positions[0], moved.positions[4]);
    EXPECT_EQ(moved.positions[2], moved.positions[5]);
    EXPECT_NEAR(moved.positions[0].z, 2.f, 1e-6f);
    EXPECT_EQ(moved.normals[0], moved.normals[4]);
}

TEST(Displaced, theTwoSidesOfAThinSheetGoApart) {
    SurfaceMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, -1}, {0, 0, -1}};
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
    const SurfaceMesh moved = displaced(mesh, std::vector<float>(6, 0.1f));
    EXPECT_NEAR(moved.positions[1].z, 0.1f, 1e-7f);
    EXPECT_NEAR(moved.positions[4].z, -0.1f, 1e-7f);
}

TEST(Displaced, refusesHeightsThatDoNotFit) {
    EXPECT_THROW(displaced(squareMesh(), {0.f}), RunError);
    EXPECT_THROW(displaced(squareMesh(), {0.f, 0.f, NAN, 0.f}), RunError);
}

} // namespace
} // namespace patina
