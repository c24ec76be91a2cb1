#pragma once
// Which texel shows which point of the surface.

#include "surface/mesh.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace patina {

/// A square map of the unit UV tile. Row 0 is the top (v = 1); texel (x, y) has its centre at
/// ((x + 0.5) / size, 1 - (y + 0.5) / size).
struct TexelMap {
    int size = 0;
    std::vector<SurfacePoint> points; ///< per texel; triangle -1 where no chart lies
    /// Texels of the gutter and the chart texel each copies, in an order in which copying one after the other is right.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> gutter;
    std::size_t covered = 0; ///< texels in charts
};

/// Rasterises the UV triangles; where charts overlap the triangle with the smallest index wins. Charts are surrounded
/// by a gutter of `gutterTexels`, each texel of which copies the nearest chart texel. \throws ModelError where the
/// surface has no UVs, a UV is not finite or lies outside the unit square (naming the face).
TexelMap makeTexelMap(const SurfaceMesh& surface, int size, int gutterTexels);

} // namespace patina
