#pragma once
// From how far outside a ball can come: the widest way to each place of the air.

#include "base/progress.h"
#include "operators/fields/surface_voxels.h"

namespace patina {

/// For every lattice point x of the air, the radius of the largest ball that can be brought from outside to x without
/// cutting the surface on the way: the largest over all paths of the smallest distance to the surface along the path.
/// The lattice is that of the voxels, or every second, third … of them where that would be more than 16 million points;
/// radii are good to half of its pitch.
class Passages {
  public:
    /// \param limit  radii of interest, voxels \throws Interrupted
    Passages(const LayerVolume& volume, int layer, const SurfaceVoxels& surface, double limit, Progress& progress);

    /// Whether a ball of this radius can come to a place (both in voxels), its own radius there included.
    bool reaches(const Imath::V3f& place, float radius) const;

  private:
    std::size_t at(int i, int j, int k) const { return (std::size_t(i) * size_.y + j) * size_.z + k; }
    void measureDistances(const SurfaceVoxels& surface);
    void widen();

    int pitch_ = 1;
    float limit_;
    Imath::V3i low_{0}, size_{0};
    std::vector<float> distance_; ///< to the surface, voxels, at most the limit; negative in metal
    std::vector<float> width_;    ///< of the widest way
};

} // namespace patina
