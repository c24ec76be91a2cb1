#include "export/texel_map.h"

#include "base/errors.h"
#include "support/on_threads.h"
#include "support/test_surfaces.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
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

TEST(TexelMap, TheGutterSurroundsTheChartAndItsRim) {
    const TexelMap map = makeTexelMap(insetSheet(), 64, 4);
    std::vector<char> rim(64 * 64, 0), filled(64 * 64, 0);
    for (const RimTexel& texel : map.rim) {
        EXPECT_LT(map.points[texel.texel].triangle, 0);
        rim[texel.texel] = filled[texel.texel] = 1;
    }
    // Two texels around the chart, then two more; those at the very corners lie further away.
    EXPECT_EQ(map.rim.size(), std::size_t(36 * 36 - 32 * 32 - 4));
    EXPECT_EQ(map.rim.size() + map.gutter.size(), std::size_t(40 * 40 - 32 * 32 - 4));
    for (const auto& [to, from] : map.gutter) {
        EXPECT_LT(map.points[to].triangle, 0);
        EXPECT_TRUE(map.points[from].triangle >= 0 || rim[from]);
        EXPECT_FALSE(filled[to]);
        filled[to] = 1;
        const int dx = int(to % 64) - int(from % 64), dy = int(to / 64) - int(from / 64);
        EXPECT_LE(std::max(std::abs(dx), std::abs(dy)), 4);
    }
}

TEST(TexelMap, TheRimShowsTheBorderWhereTheSurfaceIsOpen) {
    const SurfaceMesh surface = insetSheet();
    for (const RimTexel& texel : makeTexelMap(surface, 64, 4).rim) {
        const double u = (texel.texel % 64 + 0.5) / 64, v = 1.0 - (texel.texel / 64 + 0.5) / 64;
        const Imath::V3d shown = positionAt(surface, texel.shown);
        EXPECT_NEAR(shown.x, std::clamp((u - 0.25) * 2, 0.0, 1.0), 1e-5);
        EXPECT_NEAR(shown.y, std::clamp((v - 0.25) * 2, 0.0, 1.0), 1e-5);
    }
}

// The sheet cut in two along x = 0.5; the right half is a chart of its own, turned by a right angle.
SurfaceMesh cutSheet() {
    SurfaceMesh surface = test::sheet(1.f, 8);
    const std::size_t count = surface.uvs.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Imath::V2f uv = surface.uvs[i];
        surface.uvs.push_back(Imath::V2f(0.9f - 0.6f * uv.y, 0.5f + 0.6f * (uv.x - 0.5f)));
        surface.uvs[i] = Imath::V2f(0.1f) + uv * 0.6f;
    }
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        if (positionAt(surface, {static_cast<int>(t), 1.f / 3, 1.f / 3}).x > 0.5)
            surface.triangleUvs[t] += Imath::V3i(static_cast<int>(count));
    // Charts side by side: the left one below 0.4, the turned one from 0.5 up.
    for (std::size_t i = 0; i < count; ++i)
        surface.uvs[i] = Imath::V2f(surface.uvs[i].x * 0.7f + 0.02f, surface.uvs[i].y * 0.5f);
    return surface;
}

TEST(TexelMap, TheRimShowsWhatLiesBeyondTheSeam) {
    const SurfaceMesh surface = cutSheet();
    const int size = 128;
    const TexelMap map = makeTexelMap(surface, size, 4);
    int beyond = 0;
    for (const RimTexel& texel : map.rim) {
        // Where the texel lies by its own chart's UVs, which are linear here.
        const Imath::V2d uv((texel.texel % size + 0.5) / size, 1.0 - (texel.texel / size + 0.5) / size);
        const bool left = positionAt(surface, {texel.border.triangle, 1.f / 3, 1.f / 3}).x < 0.5;
        const Imath::V2d place = left ? Imath::V2d(((uv.x - 0.02) / 0.7 - 0.1) / 0.6, (uv.y / 0.5 - 0.1) / 0.6)
                                      : Imath::V2d((uv.y - 0.5) / 0.6 + 0.5, (0.9 - uv.x) / 0.6);
        const Imath::V3d shown = positionAt(surface, texel.shown);
        // Where the sheet ends too, the walk ends there.
        if (place.x < 0.0 || place.x > 1.0 || place.y < 0.0 || place.y > 1.0)
            continue;
        EXPECT_NEAR(shown.x, place.x, 1e-5);
        EXPECT_NEAR(shown.y, place.y, 1e-5);
        beyond += left == (shown.x > 0.5);
    }
    EXPECT_GT(beyond, 100);
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
        EXPECT_EQ(error.place(), "face 64"); // counted from 1, as everywhere
    }
    surface.uvs.back().x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(makeTexelMap(surface, 64, 0), ModelError);
    surface.triangleUvs.clear();
    EXPECT_THROW(makeTexelMap(surface, 64, 0), ModelError);
}

TEST(TexelMap, OverlappingChartsNameTheirFaces) {
    SurfaceMesh surface = insetSheet();
    for (auto& uv : surface.uvs) // the halves on each other, mirrored
        uv.x = std::abs(uv.x - 0.5f);
    try {
        makeTexelMap(surface, 128, 0);
        FAIL();
    } catch (const ModelError& error) {
        // Triangles are drawn in order within bands of 32 rows: the fifth row of eight quads is the first of its band.
        EXPECT_EQ(error.place(), "faces 36 and 37");
        EXPECT_NE(error.message().find("lie on each other"), std::string::npos);
        EXPECT_NE(error.remedy().find("--atlas"), std::string::npos);
    }
    EXPECT_THROW(checkCharts(surface, 128), ModelError);
    EXPECT_NO_THROW(checkCharts(insetSheet(), 128));
}

TEST(TexelMap, AFaceOfManyTrianglesDoesNotOverlapItself) {
    SurfaceMesh surface = test::sheet(1.f, 8);
    for (std::size_t i = 0; i < surface.uvs.size(); ++i) // a crease of one column, as curved UVs may have
        if (i % 9 == 4)
            surface.uvs[i].x -= 0.2f;
    std::fill(surface.triangleFaces.begin(), surface.triangleFaces.end(), 0);
    EXPECT_EQ(makeTexelMap(surface, 128, 0).overlapping, 0u);
}

TEST(TexelMap, TilesAreFoundAndDrawnApart) {
    SurfaceMesh surface = test::sheet(1.f, 8);
    const std::size_t count = surface.uvs.size();
    for (std::size_t i = 0; i < count; ++i)
        surface.uvs.push_back(surface.uvs[i] + Imath::V2f(2.f, 1.f));
    for (std::size_t t = 64; t < surface.triangleUvs.size(); ++t)
        surface.triangleUvs[t] += Imath::V3i(static_cast<int>(count));
    const auto tiles = uvTiles(surface);
    ASSERT_EQ(tiles.size(), 2u);
    EXPECT_EQ(udimOf(tiles[0]), 1001);
    EXPECT_EQ(udimOf(tiles[1]), 1013);
    const SurfaceWalk walk(surface);
    for (const auto& tile : tiles) {
        const TexelMap map = makeTexelMap(walk, 64, 4, tile);
        EXPECT_EQ(map.covered, 32u * 64u); // the lower half in the first, the upper half in the other
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x)
                if (const SurfacePoint& point = map.points[y * 64 + x]; point.triangle >= 0) {
                    const Imath::V3d p = positionAt(surface, point);
                    ASSERT_NEAR(p.x, (x + 0.5) / 64, 1e-5);
                    ASSERT_NEAR(p.y, 1.0 - (y + 0.5) / 64, 1e-5);
                }
    }
    surface.uvs[surface.triangleUvs[0][0]].x = 1.5f; // a face in two tiles
    EXPECT_THROW(uvTiles(surface), ModelError);
}

TEST(TexelMap, IsTheSameOnAnyNumberOfThreads) {
    SurfaceMesh surface = test::sphere(1.f, 4);
    for (const auto& p : surface.positions) // seen from above and, beside it, from below
        surface.uvs.emplace_back(0.25f + 0.24f * p.x, 0.5f + 0.24f * p.y);
    for (const auto& p : surface.positions)
        surface.uvs.emplace_back(0.75f - 0.24f * p.x, 0.5f + 0.24f * p.y);
    surface.triangleUvs = surface.triangles;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        if (positionAt(surface, {static_cast<int>(t), 1.f / 3, 1.f / 3}).z < 0.0)
            surface.triangleUvs[t] += Imath::V3i(static_cast<int>(surface.positions.size()));
    std::vector<float> first;
    for (const std::size_t threads : {1, 2, 4})
        test::onThreads(threads, [&] {
            const TexelMap map = makeTexelMap(surface, 128, 8);
            std::vector<float> all;
            for (const SurfacePoint& point : map.points)
                all.insert(all.end(), {float(point.triangle), point.u, point.v});
            for (const RimTexel& texel : map.rim)
                all.insert(all.end(), {float(texel.texel), float(texel.shown.triangle), texel.shown.u, texel.shown.v});
            for (const auto& [to, from] : map.gutter)
                all.insert(all.end(), {float(to), float(from)});
            if (first.empty())
                first = all;
            EXPECT_EQ(all, first);
        });
}

} // namespace
} // namespace patina
