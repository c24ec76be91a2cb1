#pragma once
// The grid of material IDs, kept true to the interfaces.

#include "volume/layer_volume.h"

namespace patina {

/// Gives every voxel of the band the ID of the outermost material present in it. Present means: thicker than
/// `presenceUm` (real µm) along the normal within the voxel. Only voxels whose ID changes are written.
/// \return the number of voxels whose ID changed
std::size_t updateMaterialIds(LayerVolume& volume, double presenceUm = 1e-3);

} // namespace patina
