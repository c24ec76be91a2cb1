#pragma once
// What air reaches: pores and cavities that are closed to the outside are neither coated nor filled.

#include "volume/layer_volume.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

/// The air around a volume's present surface (phi_n > 0), split into what the outside reaches over voxels that share
/// faces, and what it does not. Cavities larger than the band count as a whole, channels narrower than a voxel as
/// closed. Of a region, air that touches a side of the box is open. The same on any number of threads. Cheap where
/// nothing is closed (a few nanoseconds per voxel): operators look before every step.
class OpenAir {
  public:
    explicit OpenAir(const LayerVolume& volume);
    /// The air there would be if the surface were at `level` (scene units, in the order of the base's leaves and active
    /// voxels).
    OpenAir(const LayerVolume& volume, const std::vector<float>& level);

    /// Whether there is any closed air. Otherwise nothing is sealed, and the masks are empty.
    bool anyClosed() const { return !sealed_.empty(); }
    /// Pores and cavities that air does not reach, and their voxels in the band.
    std::size_t closedPores() const { return closedPores_; }
    std::size_t closedVoxels() const { return closedVoxels_; }

    /// One bit per voxel of a leaf, x slowest, in the order of the base's leaves.
    using Mask = std::array<std::uint64_t, 8>;
    /// Voxels of leaf n that no coat may change: closed air, and metal or layers whose nearest air is closed.
    const Mask& sealed(std::size_t n) const;
    bool isSealed(std::size_t n, unsigned voxel) const { return sealed(n)[voxel >> 6] >> (voxel & 63) & 1; }

  private:
    void find(const NestGrids& grids, int top, double voxelSize);

    std::vector<Mask> sealed_;
    std::size_t closedPores_ = 0, closedVoxels_ = 0;
};

/// Sets to zero what an operator would do where air does not reach the present surface.
/// \param air  of the volume as it is
/// \param thickness  in the order of the base's leaves and active voxels (see SurfaceBinding)
/// \return the number of values that were not zero before
std::size_t excludeClosedAir(const LayerVolume& volume, const OpenAir& air, std::vector<float>& thickness);

} // namespace patina
