#pragma once
// g(p) t of the same t everywhere, where the whole stack is a small part of a voxel (isThinStack): p is the model's
// closest point. Includes OpenVDB: for operators/ sources.

#include "operators/slope_kernel.h"
#include "operators/surface_operation.h"
#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"
#include "volume/nest_sampler.h"

#include <array>
#include <mutex>
#include <optional>
#include <vector>

namespace patina {

/// How far the surface's level set moves in each voxel. Valid while the surface is unchanged; safe from any thread.
class EvenShift {
  public:
    /// \param thickness  t, scene units
    EvenShift(const Workpiece& work, double thickness);

    /// Fills budget[position] for all voxels of leaf n, 0 where they are not active. Within reach of the present and
    /// the new surface, and one cell more, every voxel has its own slope; farther away, where no crossing can come by a
    /// shift of this kind, a group of 2³ shares that of its first voxel (slopes vary by half a percent along a
    /// surface).
    void read(std::size_t n, float* budget) const;

  private:
    VoxelMask sharers(const float* phi, const VoxelMask& active) const;
    SlopeInput around(std::size_t n) const;
    float farSlope(const Imath::V3f& foot) const;

    const SurfaceBinding& binding_;
    std::vector<const FloatLeaf*> leaves_;
    LeafLattice lattice_;
    float inverseVoxelSize_, thickness_;
    SlopeKernel kernel_ = slopeKernel();
    const NestGrids& grids_;
    mutable std::once_flag needed_;
    mutable std::optional<NestSampler> sampler_; ///< few models need it
};

} // namespace patina
