#include "export/seam_pieces.h"

#include "surface/uv_frame.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V2d;
using Imath::V2f;
using Imath::V2i;

namespace {

// One side of a seam, in texels.
struct Side {
    V2d start, end;
    std::size_t tile;
    V2f walls;

    // Beyond the middles of a map's first and last texels reads stay the same.
    V2d at(double s, int size) const {
        const V2d place = start + (end - start) * s;
        return {std::clamp(place.x, 0.0, size - 1.0), std::clamp(place.y, 0.0, size - 1.0)};
    }
};

// Where a side crosses lattice lines, 0…1.
void addCrossings(double from, double to, std::vector<double>& crossings) {
    if (from == to)
        return;
    for (double line = std::ceil(std::min(from, to)); line <= std::max(from, to); line += 1.0)
        crossings.push_back(std::clamp((line - from) / (to - from), 0.0, 1.0));
}

void addPieces(const std::array<Side, 2>& sides, int size, std::vector<double>& crossings,
               std::vector<SeamPiece>& pieces) {
    constexpr double shortest = 1e-6;
    crossings.assign(1, 1.0);
    for (const Side& side : sides) {
        addCrossings(side.start.x, side.end.x, crossings);
        addCrossings(side.start.y, side.end.y, crossings);
    }
    std::sort(crossings.begin(), crossings.end());
    double start = 0.0;
    for (const double end : crossings) {
        if (end - start < shortest)
            continue;
        SeamPiece piece;
        for (int i = 0; i < 2; ++i) {
            const Side& side = sides[i];
            const V2d middle = side.at(0.5 * (start + end), size);
            const int x = std::min(static_cast<int>(middle.x), size - 2);
            const int y = std::min(static_cast<int>(middle.y), size - 2);
            for (int k = 0; k < 4; ++k)
                piece.texels[4 * i + k] = seamKey(
                    side.tile, static_cast<std::uint32_t>(static_cast<std::size_t>(y + k / 2) * size + (x + k % 2)));
            const auto inCell = [&](double s) {
                const V2d place = side.at(s, size) - V2d(x, y);
                return V2f(static_cast<float>(std::clamp(place.x, 0.0, 1.0)),
                           static_cast<float>(std::clamp(place.y, 0.0, 1.0)));
            };
            piece.ends[i] = {inCell(start), inCell(end)};
            piece.walls[i] = side.walls;
        }
        pieces.push_back(piece);
        start = end;
    }
}

float jumpOf(const SeamPiece& piece, const std::array<float, 8>& weights, const std::vector<float>& heights) {
    float sum = 0.f;
    for (int i = 0; i < 8; ++i)
        sum += weights[i] * heights[piece.texels[i]];
    return sum;
}

} // namespace

std::array<float, 8> SeamPiece::weights(int half) const {
    std::array<float, 8> weights;
    for (int side = 0; side < 2; ++side) {
        const V2f place = half == 1 ? (ends[side][0] + ends[side][1]) * 0.5f : ends[side][half / 2];
        const float sign = side == 0 ? 1.f : -1.f;
        for (int i = 0; i < 4; ++i)
            weights[4 * side + i] = sign * (i % 2 ? place.x : 1.f - place.x) * (i / 2 ? place.y : 1.f - place.y);
    }
    return weights;
}

float SeamPiece::largestJump(const std::vector<float>& heights) const {
    float most = 0.f;
    for (int half = 0; half < 3; ++half)
        most = std::max(most, std::abs(jumpOf(*this, weights(half), heights)));
    return most;
}

bool SeamPiece::crossesWall(const std::vector<float>& heights) const {
    for (int side = 0; side < 2; ++side) {
        const auto rise = [&](int from, int to) {
            return std::abs(heights[texels[4 * side + to]] - heights[texels[4 * side + from]]);
        };
        if (std::max(rise(0, 1), rise(2, 3)) > walls[side].x || std::max(rise(0, 2), rise(1, 3)) > walls[side].y)
            return true;
    }
    return false;
}

std::vector<SeamPiece> seamPieces(const SurfaceWalk& walk, const std::vector<V2i>& tiles, int size,
                                  double voxelSize) {
    const SurfaceMesh& surface = walk.surface();
    const auto tileIndex = [&](int triangle) {
        return static_cast<std::size_t>(std::find(tiles.begin(), tiles.end(), tileOf(surface, triangle)) -
                                        tiles.begin());
    };
    std::vector<SeamPiece> pieces;
    std::vector<double> crossings;
    for (int t = 0; t < static_cast<int>(surface.triangleUvs.size()); ++t)
        for (int edge = 0; edge < 3; ++edge) {
            const int other = walk.behind(t, edge);
            if (other < 3 * t + edge || !isSeam(walk, t, edge)) // none, or seen from there
                continue;
            const int there = other / 3;
            const std::size_t tileHere = tileIndex(t), tileThere = tileIndex(there);
            const UvDerivatives uvHere = uvDerivativesOf(surface, t), uvThere = uvDerivativesOf(surface, there);
            if (tileHere >= tiles.size() || tileThere >= tiles.size() || !uvHere.valid || !uvThere.valid)
                continue;
            const auto side = [&](int triangle, int first, int second, std::size_t tile, const UvDerivatives& uv) {
                return Side{texelPlace(surface, triangle, first % 3, size, tiles[tile]),
                            texelPlace(surface, triangle, second % 3, size, tiles[tile]), tile,
                            V2f(static_cast<float>(wallHeight(uv.du.length() / size, voxelSize)),
                                static_cast<float>(wallHeight(uv.dv.length() / size, voxelSize)))};
            };
            addPieces({side(t, edge, edge + 1, tileHere, uvHere),
                       side(there, other % 3 + 1, other % 3, tileThere, uvThere)},
                      size, crossings, pieces);
        }
    return pieces;
}

} // namespace patina
