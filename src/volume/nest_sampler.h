#pragma once
// Trilinear reading of the whole nest at once. The grids share one topology, so a cell's eight corners are found once
// and every interface is then eight loads away. Includes OpenVDB: for volume/, operators/ and export/ sources.

#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace patina {

/// Eight corners of a lattice cell and where in it a point lies. Positions are in voxels (volume/index_space.h).
struct NestCell {
    std::array<std::int32_t, 8> leaf; ///< leaf index, or -1 outside, -2 inside the band's far sides
    std::array<std::int16_t, 8> voxel;
    double x, y, z; ///< 0…1 within the cell (beyond a region's sides -2…3)
};

/// A cell and where it lies, for points that move little: NestSampler::follow().
struct NestPlace {
    NestCell cell{};
    Imath::V3i lower{std::numeric_limits<int>::min()}; ///< the cell's lower corner, voxels; at first none
};

/// A read-only view of a volume; valid while its grids are neither moved nor re-allocated. Safe from any thread.
class NestSampler {
  public:
    explicit NestSampler(const NestGrids& grids);

    int interfaceCount() const { return interfaces_; } ///< n + 1: the floor and the interfaces

    /// Which k reads phi_0, the base: 0, or one of its own where the metal was eroded and the floor is phi_m.
    int reference() const { return reference_; }

    /// The cell around a point given in voxels. Of a region: the nearest cell within its sides, carried on linearly for
    /// up to two voxels.
    NestCell locate(const Imath::V3d& point) const;

    /// locate(), by a place that was found for another point: a cell is looked up where the point has left the last
    /// one.
    const NestCell& follow(const Imath::V3d& point, NestPlace& place) const;

    /// Where a voxel stands, in voxels.
    Imath::V3d position(const openvdb::Coord& index) const { return space_.position(index); }
    const IndexSpace& space() const { return space_; }

    /// phi_k at the located point, scene units, in double; k = 0 is the floor.
    double value(int k, const NestCell& cell) const;

    /// phi_k and its gradient within the cell (scene units per voxel).
    double valueAndGradient(int k, const NestCell& cell, Imath::V3d& gradient) const;

    /// |grad phi_k| at a point, scene units per voxel: central differences at the lattice points, and between them what
    /// lies between. The trilinear gradient leans where a voxel's cells end, which is where its closest point of an
    /// interface lies: on a ball of r voxels by up to 0.4 / r, and on the whole to one side. At a region's sides, where
    /// differences end, it serves all the same.
    double slope(int k, const Imath::V3d& point) const;

    /// phi_k at an index.
    float voxel(int k, const openvdb::Coord& index) const;

    /// Central difference of phi_k at an index, scene units per voxel.
    Imath::V3d centralGradient(int k, const openvdb::Coord& index) const;

  private:
    void corners(int k, const NestCell& cell, double* c) const;

    int interfaces_ = 0, reference_ = 0;
    IndexSpace space_;
    openvdb::CoordBBox sides_;                       ///< of places; empty for a whole model
    LeafLattice lattice_;                            ///< -1 outside, -2 deep inside
    std::vector<std::vector<const float*>> buffers_; ///< [k][leaf]
    std::vector<float> background_;
};

} // namespace patina
