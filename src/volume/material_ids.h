#pragma once
// The grid of material IDs, kept true to the interfaces.

#include "volume/layer_volume.h"

#include <vector>

namespace patina {

/// Gives every voxel of the band the ID of the outermost material present in it. Present means: thicker than
/// `presenceUm` (real µm) along the normal within the voxel; a voxel whose centre lies 0.9 voxels deep in the metal is
/// metal. Only voxels whose ID changes are written.
/// \param changedLeaves  where interfaces have changed, one flag per leaf of the band: only these and their neighbours
///                       are looked at. Not given: all. Where the band grew, or the palette or the layers' order
///                       changed, give none.
/// \return the number of voxels whose ID changed
std::size_t updateMaterialIds(LayerVolume& volume, double presenceUm = 1e-3,
                              const std::vector<char>* changedLeaves = nullptr);

} // namespace patina
