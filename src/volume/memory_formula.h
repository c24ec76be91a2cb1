#pragma once
// What a volume's grids take, against the least that level sets on shared leaves can take.

#include "volume/layer_volume.h"

namespace patina {

/// Four bytes for each voxel of the leaves of every level set (base, what is left of the metal, interfaces) and of the
/// IDs. Fields are apart.
double leafValueBytes(const LayerVolume& volume);

/// Bytes of those grids over leafValueBytes(): 1.05 for the leaves' masks and what stands above them in a large volume;
/// more where few leaves stand under nodes of 128³ voxels (33 kB each) and 4096³ (0.27 MB, whatever the model's size; see
/// indexOriginFor()).
double memoryOfFormula(const LayerVolume& volume);

} // namespace patina
