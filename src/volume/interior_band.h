#pragma once
// The band's inner part, where metal is eroded.

#include "volume/layer_volume.h"
#include "volume/surface_binding.h"

namespace patina {

/// Makes sure that the band holds distances at least `voxels` inside the base. Values already there keep their bits; the
/// base's new ones are exact distances to the model, the others' are carried inward (fast sweeping).
/// \return whether the band grew; the binding is then that of the grown band
bool ensureInteriorBand(LayerVolume& volume, SurfaceBinding& binding, double voxels);

/// The deepest that the metal was eroded below the base, in voxels; 0 where it never was.
double metalDepthVoxels(const LayerVolume& volume);

} // namespace patina
