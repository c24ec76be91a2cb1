#include "export/texel_map.h"

#include "base/errors.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace patina {

using Imath::V2d;
using Imath::V2f;
using Imath::V2i;

namespace {

// UVs on the border of the tile come out of other programs with rounding errors of this size.
constexpr float uvTolerance = 1e-4f;

// A texel counts as overlapped where it lies deeper than this in both triangles, texels.
constexpr double overlapDepth = 0.05;

struct Overlaps {
    std::size_t count = 0;
    std::pair<int, int> triangles{-1, -1};
};

bool sameFace(const SurfaceMesh& surface, int a, int b) {
    return a == b || (!surface.triangleFaces.empty() && surface.triangleFaces[a] == surface.triangleFaces[b]);
}

// The triangle's corners in texels, and what depends on them alone.
struct Raster {
    V2d p[3];
    double area, shortest[3]; // signed double area; its size over the length of the side opposite each corner

    Raster(const SurfaceMesh& surface, int triangle, int size, const V2i& tile) {
        for (int c = 0; c < 3; ++c)
            p[c] = texelPlace(surface, triangle, c, size, tile);
        area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
        for (int c = 0; c < 3; ++c)
            shortest[c] = std::abs(area) / std::max((p[(c + 2) % 3] - p[(c + 1) % 3]).length(), 1e-300);
    }
    bool hasArea() const { return area != 0.0 && std::isfinite(area); }
    void weights(double x, double y, double* w) const {
        w[1] = ((x - p[0].x) * (p[2].y - p[0].y) - (y - p[0].y) * (p[2].x - p[0].x)) / area;
        w[2] = ((p[1].x - p[0].x) * (y - p[0].y) - (p[1].y - p[0].y) * (x - p[0].x)) / area;
        w[0] = 1.0 - w[1] - w[2];
    }
    /// Distance to the nearest side, from inside.
    double depth(const double* w) const {
        return std::min({w[0] * shortest[0], w[1] * shortest[1], w[2] * shortest[2]});
    }
};

// The texels of the rows [firstRow, lastRow) that a triangle covers.
void rasterize(const SurfaceMesh& surface, int triangle, int firstRow, int lastRow, TexelMap& map, Overlaps& overlaps) {
    const Raster raster(surface, triangle, map.size, map.tile);
    if (!raster.hasArea())
        return;
    const V2d* p = raster.p;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({p[0].x, p[1].x, p[2].x}))));
    const int x1 = std::min(map.size - 1, static_cast<int>(std::floor(std::max({p[0].x, p[1].x, p[2].x}))));
    const int y0 = std::max(firstRow, static_cast<int>(std::ceil(std::min({p[0].y, p[1].y, p[2].y}))));
    const int y1 = std::min(lastRow - 1, static_cast<int>(std::floor(std::max({p[0].y, p[1].y, p[2].y}))));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            double w[3];
            raster.weights(x, y, w);
            if (w[1] < 0.0 || w[2] < 0.0 || w[1] + w[2] > 1.0)
                continue;
            SurfacePoint& texel = map.points[static_cast<std::size_t>(y) * map.size + x];
            if (texel.triangle < 0) {
                texel = {triangle, static_cast<float>(w[1]), static_cast<float>(w[2])};
            } else if (raster.depth(w) > overlapDepth && !sameFace(surface, texel.triangle, triangle)) {
                const Raster other(surface, texel.triangle, map.size, map.tile);
                other.weights(x, y, w);
                if (other.depth(w) > overlapDepth && overlaps.count++ == 0)
                    overlaps.triangles = {texel.triangle, triangle};
            }
        }
}

} // namespace

V2d texelPlace(const SurfaceMesh& surface, int triangle, int corner, int size, const V2i& tile) {
    const V2f& uv = surface.uvs[surface.triangleUvs[triangle][corner]];
    return {(double(uv.x) - tile.x) * size - 0.5, (1.0 + tile.y - double(uv.y)) * size - 0.5};
}

V2i tileOf(const SurfaceMesh& surface, int triangle) {
    V2d middle(0.0);
    for (int c = 0; c < 3; ++c)
        middle += V2d(surface.uvs[surface.triangleUvs[triangle][c]]);
    middle /= 3.0;
    // A triangle without an area on a tile's border belongs to the tile below.
    const auto whole = [](double x) {
        return static_cast<int>(x > 0.0 && x - std::floor(x) < 1e-9 ? std::floor(x) - 1.0 : std::floor(x));
    };
    return {whole(middle.x), whole(middle.y)};
}

int faceNumber(const SurfaceMesh& surface, int triangle) {
    return 1 + (surface.triangleFaces.empty() ? triangle : surface.triangleFaces[triangle]);
}

int udimOf(const V2i& tile) { return 1001 + tile.x + 10 * tile.y; }

std::vector<V2i> uvTiles(const SurfaceMesh& surface) {
    if (!surface.hasUvs())
        throw ModelError("model", "has no UVs", "give a model with UVs, or let --atlas make some");
    std::set<std::pair<int, int>> found;
    for (int t = 0; t < static_cast<int>(surface.triangleUvs.size()); ++t) {
        const auto refuse = [&](const V2f& uv, const char* why) {
            throw ModelError(fmt::format("face {}", faceNumber(surface, t)),
                             fmt::format("its UV ({:.4g}, {:.4g}) {}", uv.x, uv.y, why),
                             "give every face one tile (u 0 to 10, v from 0), or replace the UVs with --atlas");
        };
        for (int c = 0; c < 3; ++c) {
            const V2f& uv = surface.uvs[surface.triangleUvs[t][c]];
            const bool numbered = uv.x >= -uvTolerance && uv.x <= 10.f + uvTolerance && uv.y >= -uvTolerance &&
                                  uv.y <= 900.f + uvTolerance; // false for NaN
            if (!numbered)
                refuse(uv, "lies outside the tiles that have a number");
        }
        const V2i at = tileOf(surface, t);
        const V2i tile(std::clamp(at.x, 0, 9), std::clamp(at.y, 0, 899));
        for (int c = 0; c < 3; ++c) {
            const V2f& uv = surface.uvs[surface.triangleUvs[t][c]];
            if (uv.x < tile.x - uvTolerance || uv.x > tile.x + 1 + uvTolerance || uv.y < tile.y - uvTolerance ||
                uv.y > tile.y + 1 + uvTolerance)
                refuse(uv, fmt::format("lies outside the tile {} of its other corners", udimOf(tile)).c_str());
        }
        found.emplace(tile.y, tile.x);
    }
    std::vector<V2i> tiles;
    for (const auto& [v, u] : found)
        tiles.emplace_back(u, v);
    return tiles;
}

TexelMap makeTexelMap(const SurfaceWalk& walk, int size, int gutterTexels, const V2i& tile) {
    const SurfaceMesh& surface = walk.surface();
    TexelMap map;
    map.size = size;
    map.tile = tile;
    map.points.assign(static_cast<std::size_t>(size) * size, SurfacePoint());
    // Triangles are sorted into bands of rows once, in order, so bands can be drawn independently and the smallest
    // index wins.
    constexpr int bandRows = 32;
    const int bands = (size + bandRows - 1) / bandRows;
    std::vector<std::vector<int>> inBand(bands);
    for (int t = 0; t < static_cast<int>(surface.triangleUvs.size()); ++t) {
        double low = 1e300, high = -1e300, left = 1e300, right = -1e300;
        for (int c = 0; c < 3; ++c) {
            const V2d place = texelPlace(surface, t, c, size, tile);
            low = std::min(low, place.y);
            high = std::max(high, place.y);
            left = std::min(left, place.x);
            right = std::max(right, place.x);
        }
        if (high < -0.5 || low > size - 0.5 || right < -0.5 || left > size - 0.5)
            continue; // in another tile
        const int first = std::clamp(static_cast<int>(low - 0.5) / bandRows, 0, bands - 1);
        const int last = std::clamp(static_cast<int>(high + 1.5) / bandRows, 0, bands - 1);
        for (int b = first; b <= last; ++b)
            inBand[b].push_back(t);
    }
    std::vector<Overlaps> overlaps(bands);
    tbb::parallel_for(0, bands, [&](int b) {
        for (const int t : inBand[b])
            rasterize(surface, t, b * bandRows, std::min(size, (b + 1) * bandRows), map, overlaps[b]);
    });
    for (const SurfacePoint& point : map.points)
        map.covered += point.triangle >= 0;
    std::pair<int, int> first{-1, -1};
    for (const Overlaps& found : overlaps) {
        if (map.overlapping == 0 && found.count > 0)
            first = found.triangles;
        map.overlapping += found.count;
    }
    if (map.overlapping > 0) {
        const int a = faceNumber(surface, first.first), b = faceNumber(surface, first.second);
        map.overlappingFaces = {std::min(a, b) - 1, std::max(a, b) - 1};
        const double share = static_cast<double>(map.overlapping) / static_cast<double>(map.covered);
        if (share > overlapTolerance && map.overlapping > 4)
            throw ModelError(fmt::format("faces {} and {}", std::min(a, b), std::max(a, b)),
                             fmt::format("lie on each other in the UVs, as {:.2g} % of the charts do", 100.0 * share),
                             "give every face a place of its own in the UVs, or replace them with --atlas");
    }
    addGutter(walk, gutterTexels, map);
    return map;
}

void checkCharts(const SurfaceMesh& surface, int size) {
    const SurfaceWalk walk(surface);
    for (const V2i& tile : uvTiles(surface))
        makeTexelMap(walk, size, 0, tile);
}

TexelMap makeTexelMap(const SurfaceMesh& surface, int size, int gutterTexels) {
    const auto tiles = uvTiles(surface);
    return makeTexelMap(SurfaceWalk(surface), size, gutterTexels, tiles.empty() ? V2i(0, 0) : tiles[0]);
}

} // namespace patina
