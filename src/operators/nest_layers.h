#pragma once
// Layers that an operator has emptied, and neighbours that have become one.

#include "volume/layer_volume.h"

namespace patina {

/// Drops every layer that is thinner than a rounding error (a millionth of a voxel, half a nanometre) wherever its
/// interfaces cross zero, and merges neighbouring layers of one material.
/// \return whether layers were removed
bool tidyLayers(LayerVolume& volume);

} // namespace patina
