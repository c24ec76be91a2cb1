#pragma once
// Triangles cut from the voxels' own surface, moved onto the field between the lattice points.

#include "surface/mesh.h"
#include "volume/layer_volume.h"

namespace patina {

/// Moves vertices along their normals, by a voxel at most, onto the zero set of the outermost interface; normals stay
/// as they are. Where surfaces face each other within a voxel, ways that would turn a triangle over are shortened, and
/// their neighbours' with them: there the triangles stay near those that they were cut from.
/// \param cut  the interface's triangles split finer, with normals that face out of them, scene units
void settle(const LayerVolume& volume, SurfaceMesh& cut);

} // namespace patina
