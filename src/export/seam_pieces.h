#pragma once
// UV seams cut into pieces on which a map's bilinear reads are polynomials.

#include "export/texel_map.h"
#include "surface/surface_walk.h"

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

/// A piece of a seam between lattice lines of both sides. Along it each side reads four texels bilinearly, so that the
/// jump from side to side is a polynomial of second order: held at both ends and in the middle it stays within 5/4 of
/// what it is held to (the Lebesgue constant of three equidistant points).
struct SeamPiece {
    /// Four texels of one side, by rows, and four of the other: seamKey(); or places in a list.
    std::array<std::uint64_t, 8> texels;
    /// Its start and its end on one side and on the other, from the first of the four texels, 0…1.
    std::array<std::array<Imath::V2f, 2>, 2> ends;
    /// What is a wall from a texel to the next along x and y, on one side and on the other: wallHeight().
    std::array<Imath::V2f, 2> walls;

    /// Of the texels in the jump at the start (half 0), in the middle (1) and at the end (2).
    std::array<float, 8> weights(int half) const;
    /// The largest |jump| of these three. \param heights  by `texels`
    float largestJump(const std::vector<float>& heights) const;
    /// Whether a side reads across a wall.
    bool crossesWall(const std::vector<float>& heights) const;
};

/// A texel (y size + x) of a tile, by its index.
inline std::uint64_t seamKey(std::size_t tile, std::uint32_t texel) { return std::uint64_t(tile) << 32 | texel; }

/// The pieces of all seams, by triangles. \param tiles  as uvTiles() lists them \param size  of maps, texels \param
/// voxelSize  scene units
std::vector<SeamPiece> seamPieces(const SurfaceWalk& walk, const std::vector<Imath::V2i>& tiles, int size,
                                  double voxelSize);

} // namespace patina
