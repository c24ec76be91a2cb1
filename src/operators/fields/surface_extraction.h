#pragma once
// The present surface as triangles, for rays: where the layers are so thick that the model's own no longer stand for
// it.

#include "surface/ray_scene.h"
#include "volume/layer_volume.h"

namespace patina {

/// Triangles of an interface's zero set, scene units, in the volume's coordinates.
/// \param layer  which interface: volume.layerCount() is the present surface
RayScene extractSurface(const LayerVolume& volume, int layer);

} // namespace patina
