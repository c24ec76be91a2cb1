#pragma once
// Whose column a point of the surface lies in.

#include "operators/growth/growth_lattice.h"

#include <cstdint>
#include <vector>

namespace patina {

/// Finds the cell of a surfaceLattice() whose column holds a point: the lattice line of the point's dominant axis whose
/// square the point lies in, the crossing nearest in depth. Where facets meet, and a square belongs half to another
/// facet, the nearest cell. Thread-safe; about 50 ns.
class CellLookup {
  public:
    /// \param lattice  must outlive this
    explicit CellLookup(const GrowthLattice& lattice);

    /// \param position on the surface, in the lattice's coordinates
    /// \param normal   outward, need not be of unit length
    /// \return the cell, or GrowthLattice::noCell where there is none within three cells
    int cellAt(const Imath::V3d& position, const Imath::V3d& normal) const;

  private:
    struct Slot {
        std::uint64_t key = 0;
        std::int32_t cell = -1; ///< the first of the line's cells in order_; -1: free
        std::int32_t count = 0;
    };
    const Slot* find(int facet, std::int64_t a, std::int64_t b) const;
    void nearest(int facet, std::int64_t a, std::int64_t b, const Imath::V3d& position, double& best, int& cell) const;

    const GrowthLattice& lattice_;
    std::vector<Slot> slots_;
    std::vector<std::int32_t> order_; ///< cells, line by line
};

} // namespace patina
