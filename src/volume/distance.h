#pragma once
// True distance to an interface of the nest, for coats and erosions thicker than a voxel and for closings; thrown away
// after use (nothing ever renormalises the nest). Includes OpenVDB: for volume/ and operators/ sources only.

#include "base/progress.h"
#include "volume/distance_search.h"
#include "volume/distance_seeds.h"
#include "volume/layer_volume.h"

#include <vector>

namespace patina {

/// Distance to the set where a level set's trilinear interpolant is `iso`: the nearest of its seeds is found exactly,
/// then the foot on that seed's curved patch. Works on any block, whether the grid has a leaf there or not. Safe from
/// any thread; results do not depend on which.
class DistanceTransform {
  public:
    /// \param iso  scene units
    DistanceTransform(const openvdb::FloatGrid& grid, double voxelSize, double iso = 0.0);

    const LevelSetBlocks& levelSet() const { return levelSet_; }
    const SurfaceSeeds& seeds() const { return seeds_; }
    bool empty() const { return seeds_.points.size() == 0; }

    /// The nearest seed of every voxel of a block that is asked for.
    void nearest(const openvdb::Coord& block, const SearchWindow& window, NearestInBlock& result) const {
        search_.search(block, window, result);
    }

    /// From voxel `pos` of a block to the foot on its nearest seed's patch, in voxels.
    Imath::V3f toFoot(const openvdb::Coord& block, int pos, std::int32_t seed) const {
        const Imath::V3f x(float(pos >> 6), float((pos >> 3) & 7), float(pos & 7));
        return seeds_.footOf(block, x, seed) - x;
    }

  private:
    LevelSetBlocks levelSet_;
    SurfaceSeeds seeds_;
    NearestPoints search_;
};

/// What is known of every voxel of the band, in the order of the base's leaves and active voxels.
struct DistanceField {
    std::vector<float> distance;     ///< signed as phi_k is, scene units
    std::vector<Imath::V3f> toFoot;  ///< from the voxel to the closest point of phi_k, in voxels; where asked for
};

struct DistanceOptions {
    bool inside = true, outside = true; ///< where not asked for, phi_k itself is given and no foot (0, 0, 0)
    bool feet = false;
};

/// The distance to interface k (0: the floor) in the whole band. Where phi_k has no zero set, phi_k itself.
DistanceField distanceToInterface(const LayerVolume& volume, int k, const DistanceOptions& options,
                                  Progress& progress);

} // namespace patina
