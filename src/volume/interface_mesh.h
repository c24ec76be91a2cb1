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

/// Moves vertices that lie near an interface, as those of its triangles cut finer, along their normals onto its zero
/// set: to the nearest place within a voxel where the normal leads out of the solid. So each stays on its own side of a
/// gap, however narrow. One that finds none stays where it is; normals are left as they are.
void settleOnInterface(const LayerVolume& volume, int layer, SurfaceMesh& mesh);

/// How an interface's level set rises at these points, by differences over a voxel: the outward normal times a length
/// of about 1, less where surfaces face each other within a voxel; 0 where the band does not reach.
std::vector<Imath::V3f> interfaceSlopes(const LayerVolume& volume, int layer, const std::vector<Imath::V3f>& points);

/// The same of the original metal, also where it was eroded.
std::vector<Imath::V3f> baseSlopes(const LayerVolume& volume, const std::vector<Imath::V3f>& points);

/// What the level set of the original metal is at these points; voxels, as far as the band reaches. At points of the
/// model it says what the voxels made of its surface: above 0 they rounded an edge off, below 0 they filled a crease.
std::vector<float> baseDistances(const LayerVolume& volume, const std::vector<Imath::V3f>& points);

/// Whether a point, in the volume's coordinates, lies in the metal or in one of its layers.
bool isInsideVolume(const LayerVolume& volume, const Imath::V3f& point);

} // namespace patina
