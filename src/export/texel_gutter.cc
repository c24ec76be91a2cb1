#include "export/texel_map.h"

#include "surface/uv_frame.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

using Imath::V2d;
using Imath::V3d;

namespace {

// The nearest point of a chart's border to a texel.
struct Nearest {
    float distance = std::numeric_limits<float>::max(); // squared, texels
    int code = -1;                                      // 3 triangle + edge
    float along = 0.f;                                  // 0…1 from the edge's first corner
};

void nearTexels(const SurfaceMesh& surface, int code, int firstRow, int lastRow, const TexelMap& map,
                std::vector<Nearest>& band) {
    const int triangle = code / 3, edge = code % 3;
    const V2d a = texelPlace(surface, triangle, edge, map.size, map.tile);
    const V2d b = texelPlace(surface, triangle, (edge + 1) % 3, map.size, map.tile);
    const V2d side = b - a;
    const double squared = side.length2();
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min(a.x, b.x) - rimTexels)));
    const int x1 = std::min(map.size - 1, static_cast<int>(std::floor(std::max(a.x, b.x) + rimTexels)));
    const int y0 = std::max(firstRow, static_cast<int>(std::ceil(std::min(a.y, b.y) - rimTexels)));
    const int y1 = std::min(lastRow - 1, static_cast<int>(std::floor(std::max(a.y, b.y) + rimTexels)));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            if (map.points[static_cast<std::size_t>(y) * map.size + x].triangle >= 0)
                continue;
            const V2d at(x, y);
            const double along = squared > 0.0 ? std::clamp((at - a).dot(side) / squared, 0.0, 1.0) : 0.0;
            const auto distance = static_cast<float>((a + side * along - at).length2());
            Nearest& nearest = band[static_cast<std::size_t>(y - firstRow) * map.size + x];
            if (distance < nearest.distance && distance <= rimTexels * rimTexels)
                nearest = {distance, code, static_cast<float>(along)};
        }
}

RimTexel rimTexel(const SurfaceWalk& walk, const TexelMap& map, std::uint32_t texel, const Nearest& nearest) {
    const SurfaceMesh& surface = walk.surface();
    const int triangle = nearest.code / 3, edge = nearest.code % 3;
    double weight[3] = {0.0, 0.0, 0.0};
    weight[edge] = 1.0 - nearest.along;
    weight[(edge + 1) % 3] = nearest.along;
    RimTexel rim;
    rim.texel = texel;
    rim.border = {triangle, static_cast<float>(weight[1]), static_cast<float>(weight[2])};
    rim.shown = rim.border;
    const UvDerivatives derivatives = uvDerivativesOf(surface, triangle);
    if (!derivatives.valid)
        return rim;
    const V2d a = texelPlace(surface, triangle, edge, map.size, map.tile);
    const V2d b = texelPlace(surface, triangle, (edge + 1) % 3, map.size, map.tile);
    const V2d step = V2d(texel % map.size, texel / map.size) - (a + (b - a) * double(nearest.along));
    // Rows run against v.
    rim.shown = walk.from(rim.border, (derivatives.du * step.x - derivatives.dv * step.y) / map.size);
    return rim;
}

void makeRim(const SurfaceWalk& walk, TexelMap& map) {
    const SurfaceMesh& surface = walk.surface();
    constexpr int bandRows = 32;
    const int bands = (map.size + bandRows - 1) / bandRows;
    std::vector<std::vector<int>> inBand(bands);
    for (int t = 0; t < static_cast<int>(surface.triangleUvs.size()); ++t) {
        if (tileOf(surface, t) != map.tile)
            continue;
        for (int edge = 0; edge < 3; ++edge) {
            if (walk.behind(t, edge) >= 0 && !isSeam(walk, t, edge))
                continue;
            const double ya = texelPlace(surface, t, edge, map.size, map.tile).y;
            const double yb = texelPlace(surface, t, (edge + 1) % 3, map.size, map.tile).y;
            const auto band = [&](double y) { return static_cast<int>(std::clamp(y, 0.0, map.size - 1.0)) / bandRows; };
            for (int b = band(std::min(ya, yb) - rimTexels); b <= band(std::max(ya, yb) + rimTexels); ++b)
                inBand[b].push_back(3 * t + edge);
        }
    }
    std::vector<std::vector<RimTexel>> rims(bands);
    tbb::parallel_for(0, bands, [&](int b) {
        if (inBand[b].empty())
            return;
        const int firstRow = b * bandRows, lastRow = std::min(map.size, firstRow + bandRows);
        std::vector<Nearest> band(static_cast<std::size_t>(lastRow - firstRow) * map.size);
        for (const int code : inBand[b])
            nearTexels(surface, code, firstRow, lastRow, map, band);
        for (std::size_t i = 0; i < band.size(); ++i)
            if (band[i].code >= 0)
                rims[b].push_back(rimTexel(
                    walk, map, static_cast<std::uint32_t>(static_cast<std::size_t>(firstRow) * map.size + i), band[i]));
    });
    for (const auto& rim : rims)
        map.rim.insert(map.rim.end(), rim.begin(), rim.end());
}

} // namespace

bool isSeam(const SurfaceWalk& walk, int triangle, int edge) {
    const int other = walk.behind(triangle, edge);
    const SurfaceMesh& surface = walk.surface();
    const auto uv = [&](int t, int corner) { return surface.uvs[surface.triangleUvs[t][corner % 3]]; };
    return other >= 0 &&
           (uv(triangle, edge) != uv(other / 3, other % 3 + 1) || uv(triangle, edge + 1) != uv(other / 3, other % 3));
}

void addGutter(const SurfaceWalk& walk, int gutterTexels, TexelMap& map) {
    map.rim.clear();
    map.gutter.clear();
    if (gutterTexels <= 0)
        return;
    makeRim(walk, map);
    // Breadth first from charts and rims; a texel takes the source of the neighbour that reached it first.
    const int size = map.size;
    std::vector<char> taken(map.points.size());
    for (std::size_t i = 0; i < map.points.size(); ++i)
        taken[i] = map.points[i].triangle >= 0;
    for (const RimTexel& rim : map.rim)
        taken[rim.texel] = 1;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> front, next;
    const auto spread = [&](std::uint32_t texel, std::uint32_t source) {
        const int x = static_cast<int>(texel % size), y = static_cast<int>(texel / size);
        static constexpr int neighbours[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
        for (const auto& step : neighbours) {
            const int nx = x + step[0], ny = y + step[1];
            if (nx < 0 || ny < 0 || nx >= size || ny >= size)
                continue;
            const auto n = static_cast<std::uint32_t>(static_cast<std::size_t>(ny) * size + nx);
            if (!taken[n]) {
                taken[n] = 1;
                next.emplace_back(n, source);
            }
        }
    };
    for (const RimTexel& rim : map.rim)
        spread(rim.texel, rim.texel);
    for (int ring = static_cast<int>(rimTexels); ring < gutterTexels && !next.empty(); ++ring) {
        map.gutter.insert(map.gutter.end(), next.begin(), next.end());
        front.swap(next);
        next.clear();
        if (ring + 1 < gutterTexels)
            for (const auto& [texel, source] : front)
                spread(texel, source);
    }
    tbb::parallel_sort(map.gutter.begin(), map.gutter.end()); // each texel once: one order
}

} // namespace patina
