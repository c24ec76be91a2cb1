#pragma once
// A level set as blocks of plain numbers, with a margin taken from the neighbours. Includes OpenVDB: for sources only.

#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <vector>

namespace patina {

/// A read-only view of a level set's leaves; valid while the grid is neither moved nor re-allocated.
class LevelSetBlocks {
  public:
    explicit LevelSetBlocks(const openvdb::FloatGrid& grid);

    const std::vector<const FloatLeaf*>& leaves() const { return leaves_; }
    const LeafLattice& lattice() const { return lattice_; }
    float background() const { return background_; }

    /// The leaf at a block, or null.
    const FloatLeaf* leafAt(const openvdb::Coord& block) const {
        const std::int32_t number = lattice_.at(block.x(), block.y(), block.z());
        return number < 0 ? nullptr : leaves_[number];
    }
    /// What a block without a leaf holds throughout.
    float fillAt(const openvdb::Coord& block) const {
        return lattice_.at(block.x(), block.y(), block.z()) == -2 ? -background_ : background_;
    }

    /// Values from `low` voxels before a block to `high` voxels behind it (each at most 8) on every axis;
    /// `values` takes (low + 8 + high)³ numbers, z fastest.
    void padded(const openvdb::Coord& block, int low, int high, float* values) const;

  private:
    std::vector<const FloatLeaf*> leaves_;
    LeafLattice lattice_; ///< -1 outside, -2 inside
    float background_;
};

} // namespace patina
