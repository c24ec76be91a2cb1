#pragma once
// Distances to a surface of particles, with little memory. Includes OpenVDB: for operators/ sources only.

#include "volume/distance_search.h"
#include "volume/level_set_blocks.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

/// The zero set of a grown interface as points, one in each cell that it crosses, and a piece of plane around each. In
/// a porous layer every second cell has one, so that the patches of DistanceTransform would take more than the band;
/// here a point takes 12 bytes and its plane is read from the cell's corners when it is asked for. Curvature within a
/// cell means nothing among particles.
///
/// Reads the grids for as long as it is used: voxels beside the surface must not change meanwhile, others may.
class GrownSurface {
  public:
    /// \param grid  the new interface: values beside its zero set, elsewhere the right side
    /// \param before  phi_n, of the same topology
    /// \param voxelSize  scene units
    /// \param wanted  cells that may be somebody's nearest, as makeSurfacePoints() takes them; null: all
    GrownSurface(const openvdb::FloatGrid& grid, const openvdb::FloatGrid& before, double voxelSize,
                 const std::vector<VoxelMask>* wanted);

    /// The nearest point of every voxel of a block that is asked for.
    void nearest(const openvdb::Coord& block, const SearchWindow& window, NearestInBlock& result) const {
        NearestPoints(points_).search(block, window, result);
    }

    /// How far voxel `pos` of a block is from its nearest point's piece of plane, voxels.
    /// \param bare  receives whether that piece is phi_n's own, untouched
    float distance(const openvdb::Coord& block, int pos, std::int32_t point, bool& bare) const;

  private:
    LevelSetBlocks grown_;
    std::vector<const FloatLeaf*> before_;
    PointBlocks points_;
};

} // namespace patina
