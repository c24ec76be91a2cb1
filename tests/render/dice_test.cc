#include "render/dice.h"

#include "render/displace.h"
#include "surface/weld.h"
#include "test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace patina {
namespace {

using Imath::V3f;
using Imath::V3i;

double areaOf(const SurfaceMesh& mesh) {
    double area = 0.0;
    for (const V3i& t : mesh.triangles) {
        const V3f a = mesh.positions[std::size_t(t.x)];
        area +=
            0.5 * double((mesh.positions[std::size_t(t.y)] - a).cross(mesh.positions[std::size_t(t.z)] - a).length());
    }
    return area;
}

/// Edges, by place, that do not have one triangle on each side.
int cracksOf(const SurfaceMesh& mesh) {
    const std::vector<int> places = weldedIndices(mesh.positions);
    std::map<std::pair<int, int>, int> balance;
    std::map<std::pair<int, int>, int> count;
    for (const V3i& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const int a = places[std::size_t(t[i])], b = places[std::size_t(t[(i + 1) % 3])];
            balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
            ++count[{std::min(a, b), std::max(a, b)}];
        }
    int cracks = 0;
    for (const auto& [edge, sides] : balance)
        cracks += sides != 0 || count[edge] != 2;
    return cracks;
}

/// A sphere cut along a meridian as UVs cut it: two vertices at each place there, of different neighbours.
SurfaceMesh sphereWithSeam(int n) {
    SurfaceMesh mesh = sphereMesh(n, 1.f);
    std::map<int, int> copies;
    for (V3i& t : mesh.triangles) {
        float aside = 0.f;
        for (int i = 0; i < 3; ++i)
            aside += mesh.positions[std::size_t(t[i])].y;
        for (int i = 0; i < 3; ++i) {
            const V3f p = mesh.positions[std::size_t(t[i])];
            if (aside >= 0.f || std::abs(p.y) > 1e-6f)
                continue;
            const auto [copy, isNew] = copies.try_emplace(t[i], int(mesh.positions.size()));
            if (isNew) {
                mesh.positions.push_back(p);
                mesh.normals.push_back(mesh.normals[std::size_t(t[i])]);
            }
            t[i] = copy->second;
        }
    }
    return mesh;
}

Camera closeUp() {
    CameraView view;
    view.elevationDegrees = 20.f;
    return Camera::aimed(V3f(0.f, -0.94f, 0.34f), 1.2f, view, 1.f);
}

TEST(Diced, noCrackOpensBetweenCoarseAndFineNorAlongSeams) {
    const SurfaceMesh sphere = sphereWithSeam(12);
    ASSERT_EQ(cracksOf(sphere), 0);
    DiceOptions options;
    options.pictureHeight = 64;
    const SurfaceMesh fine = diced(sphere, closeUp(), options);
    EXPECT_GT(fine.triangles.size(), 20 * sphere.triangles.size());
    EXPECT_EQ(cracksOf(fine), 0);
    EXPECT_NEAR(areaOf(fine) / areaOf(sphere), 1.0, 1e-5);
    // Nor where every vertex moves by a height of its own: those at one place share theirs.
    std::vector<float> heights;
    for (std::size_t v = 0; v < fine.positions.size(); ++v)
        heights.push_back(0.01f * float(v % 17));
    EXPECT_EQ(cracksOf(displaced(fine, heights)), 0);
}

TEST(Diced, whatIsSeenIsAsFineAsAPixelAndTheRestIsNot) {
    const SurfaceMesh sphere = sphereMesh(12, 1.f);
    const Camera camera = closeUp();
    DiceOptions options;
    options.pictureHeight = 64;
    const SurfaceMesh fine = diced(sphere, camera, options);
    float longestSeen = 0.f, longest = 0.f;
    for (const V3i& t : fine.triangles)
        for (int i = 0; i < 3; ++i) {
            const V3f a = fine.positions[std::size_t(t[i])], b = fine.positions[std::size_t(t[(i + 1) % 3])];
            longest = std::max(longest, (a - b).length());
            const Imath::V2f at = camera.project(a);
            const bool front =
                (a ^ (camera.position() - a)) > 0.f && ((a - camera.position()) ^ camera.forward()) > 0.f;
            if (!front || at.x < 0.f || at.x > 1.f || at.y < 0.f || at.y > 1.f)
                continue;
            const Imath::V2f other = camera.project(b);
            longestSeen = std::max(longestSeen, 64.f * (at - other).length());
        }
    EXPECT_LE(longestSeen, 1.05f); // pixels; off the axis a pixel is a little nearer
    EXPECT_GT(longest, 0.2f);
    for (const V3f& n : fine.normals)
        ASSERT_NEAR(n.length(), 1.f, 1e-5f);
}

TEST(Diced, itsTrianglesCanBeCountedBefore) {
    const SurfaceMesh sphere = sphereMesh(12, 1.f);
    for (const int height : {64, 128, 256}) {
        DiceOptions options;
        options.pictureHeight = height;
        const auto made = double(diced(sphere, closeUp(), options).triangles.size());
        EXPECT_NEAR(double(dicedTriangles(sphere, closeUp(), options)) / made, 1.0, 0.02) << height;
        options.mostTriangles = std::size_t(made / 2.0); // the round that passes it is the last
        EXPECT_NEAR(double(dicedTriangles(sphere, closeUp(), options)),
                    double(diced(sphere, closeUp(), options).triangles.size()), 0.02 * made)
            << height;
    }
}

// A camera close above the middle of a large triangle sees none of its edges.
TEST(Diced, aTriangleWhoseEdgesAreOutOfViewIsCutAllTheSame) {
    SurfaceMesh square = squareMesh();
    CameraView view;
    view.elevationDegrees = 90.f;
    DiceOptions options;
    options.pictureHeight = 32;
    const Camera camera = Camera::aimed(V3f(0.4f, -0.4f, 0.f), 0.5f, view, 1.f);
    const SurfaceMesh fine = diced(square, camera, options);
    EXPECT_GT(fine.triangles.size(), 32u * 32u);
    EXPECT_NEAR(areaOf(fine), 4.0, 1e-4);
    options.mostTriangles = 100; // ends with the round that passes it
    EXPECT_LT(diced(square, camera, options).triangles.size(), 1000u);
    options.toPicture = [](const V3f& p) { return p + V3f(0.f, 0.f, 100.f); }; // behind the camera
    EXPECT_EQ(diced(square, camera, options).triangles.size(), 2u);
}

} // namespace
} // namespace patina
