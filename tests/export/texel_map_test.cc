#include "export/texel_map.h"

#include "base/errors.h"
#include "support/test_surfaces.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <limits>

namespace patina {
namespace {

// A sheet whose chart is the middle half of the tile.
SurfaceMesh insetSheet() {
    SurfaceMesh surface = test::sheet(1.f, 8);
    for (auto& uv : surface.uvs)
        uv = Imath::V2f(0.25f) + uv * 0.5f;
    return surface;
}

TEST(TexelMap, TexelsShowTheirPlaceWithVUpwards) {
    const SurfaceMesh surface = insetSheet();
    const TexelMap map = makeTexelMap(surface, 64, 0);
    EXPECT_EQ(map.covered, 32u * 32u);
    for (int y = 16; y < 48; ++y)
        for (int x = 16; x < 48; ++x) {
            const SurfacePoint& point = map.points[y * 64 + x];
            ASSERT_GE(point.triangle, 0);
            const Imath::V3d p = positionAt(surface, point);
            ASSERT_NEAR(p.x, ((x + 0.5) / 64 - 0.25) * 2, 1e-5);
            ASSERT_NEAR(p.y, ((1.0 - (y + 0.5) / 64) - 0.25) * 2, 1e-5);
        }
}

TEST(TexelMap, TheGutterSurroundsTheChartAndCopiesItsBorder) {
    const TexelMap map = makeTexelMap(insetSheet(), 64, 4);
    EXPECT_EQ(map.gutter.size(), std::size_t(40 * 40 - 32 * 32));
    for (const auto& [to, from] : map.gutter) {
        EXPECT_LT(map.points[to].triangle, 0);
        EXPECT_GE(map.points[from].triangle, 0);
        const int dx = int(to % 64) - int(from % 64), dy = int(to / 64) - int(from / 64);
        EXPECT_LE(std::max(std::abs(dx), std::abs(dy)), 4);
    }
}

TEST(TexelMap, MirroredChartsAreDrawnToo) {
    SurfaceMesh surface = insetSheet();
    for (auto& uv : surface.uvs)
        uv.x = 1.f - uv.x;
    EXPECT_EQ(makeTexelMap(surface, 64, 0).covered, 32u * 32u);
}

TEST(TexelMap, DegenerateTrianglesCoverNothing) {
    SurfaceMesh surface = insetSheet();
    for (auto& uv : surface.uvs)
        uv.y = 0.5f;
    EXPECT_EQ(makeTexelMap(surface, 64, 0).covered, 0u);
}

TEST(TexelMap, UvsOutsideTheTileNameTheirFace) {
    SurfaceMesh surface = insetSheet();
    surface.uvs.back().x = 1.5f;
    try {
        makeTexelMap(surface, 64, 0);
        FAIL();
    } catch (const ModelError& error) {
        EXPECT_EQ(error.place(), "face 63");
    }
    surface.uvs.back().x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(makeTexelMap(surface, 64, 0), ModelError);
    surface.triangleUvs.clear();
    EXPECT_THROW(makeTexelMap(surface, 64, 0), ModelError);
}

TEST(TexelMap, IsTheSameOnAnyNumberOfThreads) {
    SurfaceMesh surface = insetSheet();
    for (std::size_t i = 0; i < surface.uvs.size(); ++i) // overlapping charts
        surface.uvs[i].x = std::abs(surface.uvs[i].x - 0.5f);
    std::vector<int> first;
    for (const std::size_t threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        std::vector<int> owners;
        for (const SurfacePoint& point : makeTexelMap(surface, 128, 0).points)
            owners.push_back(point.triangle);
        if (first.empty())
            first = owners;
        EXPECT_EQ(owners, first);
    }
}

} // namespace
} // namespace patina
