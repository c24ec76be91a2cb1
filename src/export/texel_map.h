#pragma once
// Which texel shows which point of the surface.

#include "surface/mesh.h"
#include "surface/surface_walk.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace patina {

/// A texel beside a chart. It shows what lies there on the surface, beyond the seam, so that a map read between texel
/// centres has the same value on both sides of the seam.
struct RimTexel {
    std::uint32_t texel = 0;
    SurfacePoint border; ///< the nearest point of the chart's border, on the triangle that owns the texel
    SurfacePoint shown;  ///< as far beyond it as the texel is; the border itself where the surface is open
};

/// A square map of one UV tile. Row 0 is the top (v = 1); texel (x, y) has its centre at
/// ((x + 0.5) / size, 1 - (y + 0.5) / size), from the tile's corner.
struct TexelMap {
    int size = 0;
    Imath::V2i tile{0, 0};
    std::vector<SurfacePoint> points; ///< per texel; triangle -1 where no chart lies
    std::vector<RimTexel> rim;        ///< texels within rimTexels of a chart, by texel
    /// The rest of the gutter by texel, and the texel of a chart or rim that each copies.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> gutter;
    std::size_t covered = 0;     ///< texels in charts
    std::size_t overlapping = 0; ///< of those, texels well inside two triangles of different faces
    std::pair<int, int> overlappingFaces{-1, -1}; ///< the first two of them, from 0
};

/// How far around a chart texels show what lies beyond its border, texels: a bilinear read comes as far as √2.
constexpr double rimTexels = 2.0;

/// More overlapping texels than this share are charts laid on each other, fewer are what unwrapping leaves.
constexpr double overlapTolerance = 1e-3;

/// The UV tiles that the triangles lie in, (0, 0) alone as a rule; by v, then u. \throws ModelError where the surface
/// has no UVs, a UV is not finite, a face lies in two tiles or one that has no UDIM number (u 0…9, v 0…899), naming the
/// face, counted from 1.
std::vector<Imath::V2i> uvTiles(const SurfaceMesh& surface);

/// 1001 + u + 10 v.
int udimOf(const Imath::V2i& tile);

/// Rasterises the UV triangles of a tile. Charts are surrounded by a gutter of `gutterTexels`: the rim, and around it
/// copies of the nearest texel. Where a few texels overlap the triangle with the smallest index wins.
/// \throws ModelError as uvTiles() does, and where charts overlap, naming two faces
TexelMap makeTexelMap(const SurfaceWalk& walk, int size, int gutterTexels, const Imath::V2i& tile = {0, 0});
TexelMap makeTexelMap(const SurfaceMesh& surface, int size, int gutterTexels);

/// Whether maps can be baked. \throws ModelError where makeTexelMap() would for any tile
void checkCharts(const SurfaceMesh& surface, int size);

/// Fills rim and gutter of a map whose points are known.
void addGutter(const SurfaceWalk& walk, int gutterTexels, TexelMap& map);

/// Whether the triangle behind an edge (SurfaceWalk::behind) lies elsewhere in the UVs.
bool isSeam(const SurfaceWalk& walk, int triangle, int edge);

/// The height from a texel to the next that is a wall: four times their distance (76 degrees) and more than half a voxel,
/// which nothing that the lattice holds as one sheet rises. \param distance  of the texels, in the voxel's unit
inline double wallHeight(double distance, double voxelSize) { return std::max(0.5 * voxelSize, 4.0 * distance); }

/// UV of a corner in texels from the first texel's centre, y downwards.
Imath::V2d texelPlace(const SurfaceMesh& surface, int triangle, int corner, int size, const Imath::V2i& tile);
/// The tile of a triangle: that of its middle.
Imath::V2i tileOf(const SurfaceMesh& surface, int triangle);

/// A face's number for people, from 1.
int faceNumber(const SurfaceMesh& surface, int triangle);

} // namespace patina
