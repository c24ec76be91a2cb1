#include "surface/triangulate.h"

#include "surface/limit_surface.h"
#include "test_models.h"

#include <cmath>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

double areaOf(const std::vector<V3f>& p, const V3i& t) {
    return 0.5 * (V3d(p[t.y]) - V3d(p[t.x])).cross(V3d(p[t.z]) - V3d(p[t.x])).z;
}

/// Counter-clockwise polygon in z = 0: every triangle must turn the same way and the areas must add up, which only a
/// cut without overlaps can do.
void expectExactCover(const std::vector<V3f>& polygon, double area) {
    std::vector<int> corners;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        corners.push_back(static_cast<int>(i));
    std::vector<V3i> triangles;
    triangulatePolygon(polygon, corners.data(), static_cast<int>(corners.size()), triangles);
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    double sum = 0.0;
    for (const V3i& triangle : triangles) {
        EXPECT_GE(areaOf(polygon, triangle), 0.0);
        sum += areaOf(polygon, triangle);
    }
    EXPECT_NEAR(sum, area, 1e-6 * area);
}

TEST(Triangulate, concaveQuadIsCutAlongTheDiagonalInside) {
    // The dart's outer diagonal (1–3, length 2) is longer than the inner one here, and shorter in the second dart.
    expectExactCover({{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5f, 1, 0}}, 1.5);
    expectExactCover({{0, -3, 0}, {0.5f, 3, 0}, {0, 2, 0}, {-0.5f, 3, 0}}, 2.5);
}

TEST(Triangulate, concavePolygonsAreCoveredOnce) {
    expectExactCover({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, 5.0); // an L
    std::vector<V3f> star;
    for (int i = 0; i < 20; ++i) {
        const double radius = i % 2 ? 1.0 : 3.0, angle = M_PI * i / 10;
        star.emplace_back(static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)),
                          0.f);
    }
    // Twenty triangles between neighbouring radii of 1 and 3, 18° apart.
    expectExactCover(star, 20 * 0.5 * 3.0 * std::sin(M_PI / 10));
}

TEST(Triangulate, cornersInAStraightLineCostNoArea) {
    expectExactCover({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}, 4.0);
}

TEST(Triangulate, regularPolygonIsCovered) {
    std::vector<V3f> polygon;
    for (int i = 0; i < 17; ++i)
        polygon.emplace_back(static_cast<float>(std::cos(2 * M_PI * i / 17)),
                             static_cast<float>(std::sin(2 * M_PI * i / 17)), 0.f);
    expectExactCover(polygon, 17 * 0.5 * std::sin(2 * M_PI / 17));
}

TEST(Triangulate, polygonsWithoutAreaStillEnd) {
    std::vector<V3i> triangles;
    const std::vector<V3f> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
    const int corners[] = {0, 1, 2, 3, 4};
    triangulatePolygon(line, corners, 5, triangles);
    EXPECT_EQ(triangles.size(), 3u);
}

TEST(Triangulate, normalsDoNotDependOnHowFacesAreCut) {
    LimitSurfaceOptions options;
    options.scheme = SubdivisionScheme::none;
    const SurfaceMesh cube = makeLimitSurface(makeCube(), options);
    for (std::size_t i = 0; i < cube.positions.size(); ++i)
        EXPECT_LT((cube.normals[i] - cube.positions[i].normalized()).length(), 1e-6f);
    EXPECT_TRUE(cube.closed);
    EXPECT_NEAR(cube.area(), 24.0, 1e-9);
}

} // namespace
} // namespace patina
