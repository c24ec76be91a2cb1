#pragma once
// Erosion from outside through walls behind which there is closed air.

#include "operators/surface_operation.h"
#include "volume/open_air.h"

#include <vector>

namespace patina {

/// How far phi_n rises in the voxels that closed air is nearest to (OpenAir::isSealed): there the surface is that of a
/// pore, which no erosion reaches before it has come through the wall from outside. D being the distance to the surface
/// that faces open air and t the thickness of the map there,
///
///     rise = max(0, D + t - phi_n).
///
/// Distances go round metal that stays: straight where it does not lie between, else from voxel to voxel.
///
/// \param drawn  largest thickness, scene units
/// \param throughMetal  the metal goes too: all distances are straight
/// \return scene units, in the order of the base's leaves and active voxels; 0 in all other voxels
std::vector<float> sealedRise(const Workpiece& work, const OpenAir& air, double drawn, const ThicknessMap* map,
                              bool throughMetal, Progress& progress);

} // namespace patina
