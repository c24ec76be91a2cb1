#pragma once
// Values of surface voxels as a grid on the band, and as a map.

#include "operators/fields/surface_voxels.h"
#include "operators/maps/thickness_map.h"

#include <string>

namespace patina {

/// Puts a field into the volume (NestGrids::fields) under a name, replacing one of that name. Surface voxels hold their
/// values; all others of the band the value at their closest point of the surface (where several parts are as close:
/// the mean of their neighbours), so that reading at the bare metal or above a thick layer works alike.
/// \param layer   the interface that `surface` was found on
/// \param values  one per surface voxel, >= 0
void storeField(LayerVolume& volume, const std::string& name, int layer, const SurfaceVoxels& surface,
                const std::vector<float>& values);

/// Reads a field of the volume, trilinearly, at positions in the volume's coordinates. Keeps a copy: the volume may
/// change meanwhile. \throws RunError where the volume has no such field
ThicknessMapPtr makeFieldMap(const LayerVolume& volume, const std::string& name);

} // namespace patina
