#pragma once
// The lattice on which layers grow: cells on a surface, each with a place, a share of the area and up to four
// neighbours.

#include "surface/mesh.h"

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

/// Cells of pitch `cell`; all vectors have one entry per cell. Slots 0, 1 of the neighbours lie along one tangential
/// direction of the cell (backwards, forwards), slots 2, 3 along the other.
struct GrowthLattice {
    static constexpr int noCell = -1;

    double cell = 1.0;                          ///< pitch, scene units
    std::vector<Imath::V3i> keys;               ///< lattice coordinate: what random numbers are keyed by
    std::vector<std::array<int, 4>> neighbours; ///< indices or noCell; the relation is symmetric
    std::vector<float> areas;                   ///< area of surface per cell, in units of cell²
    std::vector<Imath::V3f> centres;            ///< on the surface, scene units
    std::vector<Imath::V3f> normals;            ///< outward, unit
    std::vector<std::uint8_t> axes;             ///< the axis (0, 1, 2) along which the cell's column runs
    Imath::V3d period{0.0, 0.0, 0.0};           ///< scene units; 0: does not repeat along that axis

    std::size_t size() const { return keys.size(); }
};

/// A plane of width x height cells at z = 0, in row order; height 1 makes a line (the "1+1" lattice of the
/// literature), whose cells have two neighbours. `periodic` joins opposite borders: for measuring statistics.
/// \throws RunError when a side is smaller than 1 or there are more cells than a 32-bit index counts.
GrowthLattice flatLattice(int width, int height, bool periodic, double cell = 1.0);

/// The digital surface of a mesh, open or closed: one cell where a lattice line meets the surface, taken along the
/// dominant axis of the normal there. Lines lie at (i + 1/2, j + 1/2) * cellSize from the model's origin, so any piece
/// of a model has the cells of the whole, bit for bit; links agree with the whole's from latticeMarginCells inward of
/// the cut. A cell stands for cell² / |n_d| of surface (n_d: the component along its axis), which makes every sum over
/// cells an unbiased integral over the surface.
/// \throws RunError when cellSize is not positive or the lattice would have too many cells.
GrowthLattice surfaceLattice(const SurfaceMesh& surface, double cellSize);

/// How far from a cut (in cells) a cell's links may differ from those in the whole model.
constexpr int latticeMarginCells = 40;

/// From one cell's centre to another's, the short way round where the lattice repeats; scene units.
Imath::V3d linkVector(const GrowthLattice& lattice, int from, int to);

/// linkGauge(cell) times a link's length is its length in cells of a square lattice of the same density:
/// sqrt(area / (a b)), where a and b are the steps along the two tangential directions. It is 1 on any plane whose
/// steps are perpendicular, and 0.93 on (1,1,1), where they meet at 60 degrees.
double linkGauge(const GrowthLattice& lattice, int cell);

} // namespace patina
