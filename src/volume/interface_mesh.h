#pragma once
// An interface of the nest as triangles: the voxels' own surface, without the model it grew on.

#include "surface/mesh.h"
#include "volume/layer_volume.h"

namespace patina {

/// The zero set of an interface, scene units, in the volume's coordinates; one vertex for each cell that it crosses,
/// with the normal of the level set there (differences over a voxel). No UVs. \param layer  0 is the metal,
/// volume.layerCount() the present surface \throws RunError where there is no such interface or it crosses no voxel
SurfaceMesh interfaceMesh(const LayerVolume& volume, int layer);

} // namespace patina
