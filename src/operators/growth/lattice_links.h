#pragma once
// Who is whose neighbour on a digital surface: inside the room only.

#include "operators/growth/growth_lattice.h"

namespace patina {

/// A cell's place in the integer lattice: the voxel that holds it and the side from which it is seen.
struct CellPlace {
    Imath::V3i voxel;
    std::uint8_t facet; ///< axis * 2 + (1 where the normal points down that axis)

    bool operator<(const CellPlace& o) const {
        if (voxel.x != o.voxel.x)
            return voxel.x < o.voxel.x;
        if (voxel.y != o.voxel.y)
            return voxel.y < o.voxel.y;
        return voxel.z != o.voxel.z ? voxel.z < o.voxel.z : facet < o.facet;
    }
    bool operator==(const CellPlace& o) const { return voxel == o.voxel && facet == o.facet; }
};

/// Fills lattice.neighbours; `places` is sorted and parallel to the lattice's cells.
///
/// First each cell and the cell of the same facet in the next column choose each other, where the surface runs on from
/// one to the other. What stays free lies at seams (where the dominant axis changes, at edges and creases) and is
/// joined in a few rounds: each free side asks for the nearest cell with a free side in its direction, and those that
/// ask for each other are joined. A round looks at most three cells around, twice, so links are local.
void linkCells(GrowthLattice& lattice, const std::vector<CellPlace>& places);

} // namespace patina
