#pragma once
// The band: the active topology that all grids of a volume share.

#include "volume/layer_volume.h"

namespace patina {

/// Makes sure that the band holds distances at least `voxels` outside the base, growing every grid alike where it does
/// not. Values already there keep their bits; new ones are distances carried outward (fast sweeping).
/// \return whether the band grew (closest points kept elsewhere must then be computed again)
bool ensureExteriorBand(LayerVolume& volume, double voxels);

/// The highest any interface stands above the base in the band, in voxels.
double stackHeightVoxels(const LayerVolume& volume);

} // namespace patina
