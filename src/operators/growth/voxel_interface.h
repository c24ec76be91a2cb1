#pragma once
// From occupied voxels to an interface. Includes OpenVDB: for operators/ sources only.

#include "base/progress.h"
#include "volume/nest_grids.h"

namespace patina {

/// The union of phi_n and what has been put on it, as a level set that keeps one-voxel columns, pores and overhangs and
/// makes no terraces on slanted surfaces.
///
/// \param surface  phi_n, scene units
/// \param grid     a copy of phi_n that holds c instead, in voxels, and becomes phi_{n+1}: c = phi_n - h, where h is
/// the height above phi_n at which the
///                 voxel's own column ends. Solid: c <= 0. What lies deeper in the metal than the layer's foot has
///                 h = 0.
/// \param voxelSize  scene units, exactly as in VolumeScale
/// \param porous   h is then the top of a solid voxel's own level, the bottom of an empty one's
/// Leaves phi_{n+1} <= phi_n in `grid`; where nothing was put, the bits of phi_n. Works in place: besides the grid it
/// needs the voxels beside the surface and, while distances are found, the surface's points near the others.
///
/// A voxel next to the new surface (its 3x3x3 holds both solid and empty voxels) gets
///   c            where its neighbourhood is one compact piece: all solid voxels lower than all empty ones, or column
///                heights within a voxel of each other;
///   c, |c| <= 1  of an uneven compact layer: the top of each column stays where it is, its sides are at ±0.5;
///   0.5          of a pore (by which updateMaterialIds() knows it), -0.51 to -1.2 of a particle in a porous layer, so
///   that
///                it reads as the particle's volume; less where its centre lies lower than a voxel above phi_n,
/// at least 0.02 in size. All others get their true distance to the surface that these make, which moves no
/// crossing.
void interfaceOfVoxels(const openvdb::FloatGrid& surface, openvdb::FloatGrid& grid, double voxelSize, bool porous,
                       const Progress& progress);

} // namespace patina
