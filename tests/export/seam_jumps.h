#pragma once
// How much a map differs from one side of a UV seam to the other.

#include "displaced_distance.h"

#include "surface/surface_walk.h"
#include "surface/uv_frame.h"

namespace patina::test {

/// |difference| of the bilinear reads from both sides, at `perEdge` points of every edge of the surface whose triangles
/// do not meet in the UVs, in the map's units, sorted.
struct SeamJumps {
    std::vector<double> open;   ///< where neither side reads the fold mask
    std::vector<double> folded; ///< where one does
};

inline SeamJumps seamJumps(const SurfaceMesh& surface, const MapImage& map, const MapImage& folds,
                                     int perEdge) {
    const SurfaceWalk walk(surface);
    SeamJumps jumps;
    const auto uv = [&](int triangle, int corner) {
        return Imath::V2d(surface.uvs[surface.triangleUvs[triangle][corner % 3]]);
    };
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t)
        for (int e = 0; e < 3; ++e) {
            const int other = walk.behind(t, e);
            if (other < 3 * t + e) // none, or seen from there
                continue;
            if (!uvDerivativesOf(surface, t).valid || !uvDerivativesOf(surface, other / 3).valid)
                continue; // one of them has no place in the map
            const Imath::V2d a0 = uv(t, e), a1 = uv(t, e + 1);
            const Imath::V2d b0 = uv(other / 3, other % 3 + 1), b1 = uv(other / 3, other % 3);
            if (a0 == b0 && a1 == b1)
                continue;
            for (int i = 0; i < perEdge; ++i) {
                const double s = (i + 0.5) / perEdge;
                const Imath::V2d here = a0 + (a1 - a0) * s, there = b0 + (b1 - b0) * s;
                const bool isOpen = readMap(folds, here) == 0.0 && readMap(folds, there) == 0.0;
                (isOpen ? jumps.open : jumps.folded).push_back(std::abs(readMap(map, here) - readMap(map, there)));
            }
        }
    std::sort(jumps.open.begin(), jumps.open.end());
    std::sort(jumps.folded.begin(), jumps.folded.end());
    return jumps;
}

} // namespace patina::test
