#include "surface/atlas.h"

#include "surface/triangulate.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V2d;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

namespace {

/// The square grid of tiles, in texels where tiles are large enough to begin at whole ones.
struct Grid {
    int side;    ///< tiles along u and along v
    double tile; ///< side of a tile, texels
    double gap;  ///< between a tile's border and what is in it, texels
    double resolution;

    Grid(std::size_t tiles, int mapResolution) : resolution(std::max(mapResolution, 1)) {
        side = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(tiles)))));
        // Rounding errors of the root must not lose a tile.
        while (static_cast<std::size_t>(side) * side < tiles)
            ++side;
        tile = resolution / side;
        if (tile >= 4.0)
            tile = std::floor(tile);
        gap = tile >= 16.0 ? 2.0 : (tile >= 4.0 ? 1.0 : 0.25 * tile);
    }

    /// (x, y) in 0…1 of the inset square of tile `index`.
    V2f uv(std::size_t index, const V2d& at) const {
        const auto column = static_cast<double>(index % side), row = static_cast<double>(index / side);
        const double inner = tile - 2.0 * gap;
        return V2f(static_cast<float>((column * tile + gap + at.x * inner) / resolution),
                   static_cast<float>((row * tile + gap + at.y * inner) / resolution));
    }
};

/// Two triangles share a tile along its diagonal; legs are shortened so that the gap across the diagonal is as wide as
/// that between tiles (both hypotenuses lie gap away from the diagonal: gap · √2 along a leg).
V2d halfTileCorner(const Grid& grid, int corner, bool upper) {
    const double inner = grid.tile - 2.0 * grid.gap;
    const double leg = std::max(0.5, 1.0 - std::sqrt(2.0) * grid.gap / inner);
    const V2d lower[3] = {V2d(0.0, 0.0), V2d(leg, 0.0), V2d(0.0, leg)};
    return upper ? V2d(1.0) - lower[corner] : lower[corner];
}

/// A polygon flattened along its normal, turned so that its first edge lies along u, scaled into the square. Without
/// an area it becomes a regular polygon.
std::vector<V2d> fitPolygon(const std::vector<V3f>& positions, const int* corners, int count) {
    std::vector<V2d> points(count);
    V3d normal = polygonAreaVector(positions, corners, count);
    const V3d origin(positions[corners[0]]);
    V3d along(0.0);
    for (int i = 1; i < count && along.length2() == 0.0; ++i)
        along = V3d(positions[corners[i]]) - origin;
    if (normal.length() > 0.0) {
        normal /= normal.length();
        along -= along.dot(normal) * normal;
    }
    const bool flat = normal.length2() > 0.0 && along.length() > 0.0;
    if (flat)
        along /= along.length();
    const V3d across = normal.cross(along);
    V2d low(1e300), high(-1e300);
    for (int i = 0; i < count; ++i) {
        const double turn = 2.0 * M_PI * i / count;
        const V3d offset = V3d(positions[corners[i]]) - origin;
        points[i] = flat ? V2d(offset.dot(along), offset.dot(across)) : V2d(std::cos(turn), std::sin(turn));
        low = V2d(std::min(low.x, points[i].x), std::min(low.y, points[i].y));
        high = V2d(std::max(high.x, points[i].x), std::max(high.y, points[i].y));
    }
    const double size = std::max(high.x - low.x, high.y - low.y);
    const V2d centre = 0.5 * (low + high);
    for (V2d& point : points)
        point = V2d(0.5) + (point - centre) / size;
    return points;
}

} // namespace

void makeFaceAtlas(Mesh& mesh, int resolution) {
    const auto triangles = static_cast<std::size_t>(std::count(mesh.faceSizes.begin(), mesh.faceSizes.end(), 3));
    const std::size_t others = mesh.faceSizes.size() - triangles;
    const Grid grid(others + (triangles + 1) / 2, resolution);

    mesh.uvs.clear();
    mesh.faceUvs.clear();
    mesh.uvs.reserve(mesh.faceVertices.size());
    mesh.faceUvs.reserve(mesh.faceVertices.size());
    const V2d square[4] = {V2d(0.0, 0.0), V2d(1.0, 0.0), V2d(1.0, 1.0), V2d(0.0, 1.0)};
    std::size_t start = 0, nextTile = 0, halfTile = 0;
    bool halfFree = false;
    for (const int size : mesh.faceSizes) {
        const std::size_t tile = size == 3 && halfFree ? halfTile : nextTile++;
        std::vector<V2d> polygon;
        if (size > 4)
            polygon = fitPolygon(mesh.positions, mesh.faceVertices.data() + start, size);
        for (int corner = 0; corner < size; ++corner) {
            const V2d at = size == 3   ? halfTileCorner(grid, corner, halfFree)
                           : size == 4 ? square[corner]
                                       : polygon[corner];
            mesh.faceUvs.push_back(static_cast<int>(mesh.uvs.size()));
            mesh.uvs.push_back(grid.uv(tile, at));
        }
        if (size == 3) {
            halfTile = tile;
            halfFree = !halfFree;
        }
        start += size;
    }
}

} // namespace patina
