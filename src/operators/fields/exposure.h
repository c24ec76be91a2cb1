#pragma once
// Exposure (paper §5.2): the average irradiance that a place receives from the sun and the sky, shadowed by the model.

#include "base/progress.h"
#include "operators/fields/light_dome.h"
#include "operators/fields/open_places.h"
#include "operators/fields/surface_voxels.h"

#include <vector>

namespace patina {

struct DomeGathering {
    int rays = 256;      ///< directions per place, 1 … 65536
    bool ground = false; ///< a level plane under the model: grey, lit by the dome, shadowed by the model
    double groundAlbedo = 0.2;
    double groundHeight = 0.0; ///< along up, scene units
};

/// Irradiance of each place over the largest that any unshadowed plane receives: 0 … 1. (Under a sky that is brightest
/// at the zenith that is the horizontal one.)
///
/// Directions are drawn once, by importance, for all places; 64 sets of them alternate from voxel to voxel, so that
/// what is left of their error is fine grain and no edge of a shadow, and each voxel is averaged (by a plane)
/// with its neighbours that face the same way. A ray whose direction lies behind the surface costs nothing. Rays leave
/// from openPlaces(). The same on any number of threads. \throws RunError where the dome is dark; Interrupted
std::vector<float> gatherDome(const SurfaceVoxels& surface, double voxelSize, const LightDome& dome,
                              const Compass& compass, const Obstacles& obstacles, const DomeGathering& options,
                              Progress& progress);

/// The same for any points with normals: what gatherDome() does at the feet. `set` picks a set of directions, 0 … 63.
class DomeGatherer {
  public:
    static constexpr int sets = 64;

    DomeGatherer(const LightDome& dome, const Compass& compass, const DomeGathering& options);
    double irradiance(const Imath::V3f& position, const Imath::V3f& normal, int set, const Occlusion& occluded) const;

  private:
    std::vector<Imath::V3f> directions_; ///< of the model's space, set by set
    std::vector<Imath::V3f> upper_;      ///< the same of the dome without the ground
    std::vector<float> upperWeight_;     ///< what one of them gives to level ground, over its unshadowed irradiance
    Imath::V3f up_;
    int rays_;
    float scale_ = 0.f; ///< irradiance of one direction over the largest irradiance
    bool ground_;
    float groundHeight_;
};

} // namespace patina
