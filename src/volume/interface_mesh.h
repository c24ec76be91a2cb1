#pragma once
// An interface of the nest as triangles: the voxels' own surface, without the model it grew on.

#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <vector>

namespace patina {

/// The zero set of an interface, scene units, in the volume's coordinates; one vertex for each cell that it crosses,
/// with the normal of the level set there (differences over a voxel). No UVs. \param layer  0 is the metal,
/// volume.layerCount() the present surface \throws RunError where there is no such interface or it crosses no voxel
SurfaceMesh interfaceMesh(const LayerVolume& volume, int layer);

/// Moves vertices that lie near an interface, as those of its triangles cut finer, onto its zero set (by a voxel at
/// most; one that does not arrive stays where it is) and gives them the normals of the level set there.
void settleOnInterface(const LayerVolume& volume, int layer, SurfaceMesh& mesh);

/// The unit normals of the base's level set at these points (differences over a voxel; of the original metal, where it
/// was eroded); 0 where the band does not reach.
std::vector<Imath::V3f> baseNormals(const LayerVolume& volume, const std::vector<Imath::V3f>& points);

/// Whether a point, in the volume's coordinates, lies in the metal or in one of its layers.
bool isInsideVolume(const LayerVolume& volume, const Imath::V3f& point);

} // namespace patina
