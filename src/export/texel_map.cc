#include "export/texel_map.h"

#include "base/errors.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// UVs on the border of the tile come out of other programs with rounding errors of this size.
constexpr float uvTolerance = 1e-4f;

void checkUvs(const SurfaceMesh& surface) {
    if (!surface.hasUvs())
        throw ModelError("model", "has no UVs", "give a model with UVs, or let --atlas make some");
    for (std::size_t t = 0; t < surface.triangleUvs.size(); ++t)
        for (int c = 0; c < 3; ++c) {
            const Imath::V2f& uv = surface.uvs[surface.triangleUvs[t][c]];
            const bool inside = uv.x >= -uvTolerance && uv.x <= 1.f + uvTolerance && uv.y >= -uvTolerance &&
                                uv.y <= 1.f + uvTolerance; // false for NaN
            if (!inside)
                throw ModelError(fmt::format("face {}", surface.triangleFaces.empty() ? static_cast<int>(t)
                                                                                      : surface.triangleFaces[t]),
                                 fmt::format("its UV ({:.4g}, {:.4g}) lies outside the unit square", uv.x, uv.y),
                                 "move the UVs into one tile, or replace them with --atlas");
        }
}

// The texels of the rows [firstRow, lastRow) that a triangle covers.
void rasterize(const SurfaceMesh& surface, int triangle, int size, int firstRow, int lastRow, TexelMap& map) {
    Imath::V2d p[3];
    for (int c = 0; c < 3; ++c) {
        const Imath::V2f& uv = surface.uvs[surface.triangleUvs[triangle][c]];
        p[c] = {uv.x * double(size) - 0.5, (1.0 - uv.y) * size - 0.5};
    }
    const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (area == 0.0 || !std::isfinite(area))
        return;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({p[0].x, p[1].x, p[2].x}))));
    const int x1 = std::min(size - 1, static_cast<int>(std::floor(std::max({p[0].x, p[1].x, p[2].x}))));
    const int y0 = std::max(firstRow, static_cast<int>(std::ceil(std::min({p[0].y, p[1].y, p[2].y}))));
    const int y1 = std::min(lastRow - 1, static_cast<int>(std::floor(std::max({p[0].y, p[1].y, p[2].y}))));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double w1 = ((x - p[0].x) * (p[2].y - p[0].y) - (y - p[0].y) * (p[2].x - p[0].x)) / area;
            const double w2 = ((p[1].x - p[0].x) * (y - p[0].y) - (p[1].y - p[0].y) * (x - p[0].x)) / area;
            if (w1 < 0.0 || w2 < 0.0 || w1 + w2 > 1.0)
                continue;
            SurfacePoint& texel = map.points[static_cast<std::size_t>(y) * size + x];
            if (texel.triangle < 0)
                texel = {triangle, static_cast<float>(w1), static_cast<float>(w2)};
        }
}

void makeGutter(TexelMap& map, int width) {
    const int size = map.size;
    // Breadth first from the charts' borders; a texel takes the source of the neighbour that reached it first.
    std::vector<char> taken(map.points.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> front;
    for (std::size_t i = 0; i < map.points.size(); ++i)
        if (map.points[i].triangle >= 0) {
            taken[i] = 1;
            ++map.covered;
            front.emplace_back(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i));
        }
    for (int ring = 0; ring < width && !front.empty(); ++ring) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> next;
        for (const auto& [texel, source] : front) {
            const int x = static_cast<int>(texel % size), y = static_cast<int>(texel / size);
            static constexpr int neighbours[8][2] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                                     {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
            for (const auto& step : neighbours) {
                const int nx = x + step[0], ny = y + step[1];
                if (nx < 0 || ny < 0 || nx >= size || ny >= size)
                    continue;
                const std::size_t n = static_cast<std::size_t>(ny) * size + nx;
                if (!taken[n]) {
                    taken[n] = 1;
                    next.emplace_back(static_cast<std::uint32_t>(n), source);
                }
            }
        }
        map.gutter.insert(map.gutter.end(), next.begin(), next.end());
        front = std::move(next);
    }
}

} // namespace

TexelMap makeTexelMap(const SurfaceMesh& surface, int size, int gutterTexels) {
    checkUvs(surface);
    TexelMap map;
    map.size = size;
    map.points.assign(static_cast<std::size_t>(size) * size, SurfacePoint());
    // Triangles are sorted into bands of rows once, in order, so bands can be drawn independently and the smallest
    // index wins.
    constexpr int bandRows = 32;
    const int bands = (size + bandRows - 1) / bandRows;
    std::vector<std::vector<int>> inBand(bands);
    for (int t = 0; t < static_cast<int>(surface.triangleUvs.size()); ++t) {
        float low = 2.f, high = -1.f;
        for (int c = 0; c < 3; ++c) {
            const float v = surface.uvs[surface.triangleUvs[t][c]].y;
            low = std::min(low, v);
            high = std::max(high, v);
        }
        const int first = std::clamp(static_cast<int>((1.f - high) * size - 1.f) / bandRows, 0, bands - 1);
        const int last = std::clamp(static_cast<int>((1.f - low) * size + 1.f) / bandRows, 0, bands - 1);
        for (int b = first; b <= last; ++b)
            inBand[b].push_back(t);
    }
    tbb::parallel_for(0, bands, [&](int b) {
        for (const int t : inBand[b])
            rasterize(surface, t, size, b * bandRows, std::min(size, (b + 1) * bandRows), map);
    });
    makeGutter(map, gutterTexels);
    return map;
}

} // namespace patina
