#pragma once
// The band: the active topology that all grids of a volume share.

#include "volume/layer_volume.h"

namespace patina {

/// Makes sure that the band holds distances at least `voxels` outside the base, growing every grid alike where it does
/// not. Values already there keep their bits; new ones are true distances, and the nest stays one.
/// \return whether the band grew (closest points kept elsewhere must then be computed again)
bool ensureExteriorBand(LayerVolume& volume, double voxels);

/// Makes sure that the band reaches at least `voxels` outside the present surface, growing it only where it does not: a
/// coat on a high film of `offset` costs no wide band around the whole body.
/// \return whether the band grew
bool ensureBandAbove(LayerVolume& volume, double voxels);

/// The highest any interface stands above the base in the band, in voxels.
double stackHeightVoxels(const LayerVolume& volume);

} // namespace patina
