#pragma once
// Where among a grid's coordinates a volume is best put.

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

namespace patina {

/// The index that the model's origin gets (see volume/index_space.h), so that few nodes stand above the band's leaves:
/// OpenVDB's are cubes of 128 and 4096 voxels with tables of 33 kB and 0.27 MB, whatever they hold. The band's middle
/// comes to lie in the middle of a node of 4096, and along each axis at the middle of a node of 128, or at the border of
/// two, whichever touches fewer. Multiples of 8, so that the leaves hold the same voxels wherever they are.
/// \param voxels  what the band reaches, in voxels from the model's origin; may be empty
Imath::V3i indexOriginFor(const Imath::Box3d& voxels);

} // namespace patina
