#pragma once
// The mean of a field over the surface around each of its voxels.

#include "base/progress.h"
#include "operators/fields/surface_voxels.h"

#include <vector>

namespace patina {

/// Values weighted by a Gaussian along the surface, by diffusion from voxel to voxel; sheets that face away from each
/// other keep apart. Of a length wave on a plane exp(-2 (pi sigma / length)^2) is left.
/// \param values          one per surface voxel
/// \param deviationVoxels sigma, the Gaussian's standard deviation along each direction; 0 gives the values back
/// \throws Interrupted
std::vector<float> surfaceAverage(const SurfaceVoxels& surface, const std::vector<float>& values,
                                  double deviationVoxels, Progress& progress);

} // namespace patina
