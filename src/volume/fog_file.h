#pragma once
// How much of each voxel the layers fill, as fog volumes: for programs that render a volume by its density.

#include "volume/layer_volume.h"

#include <filesystem>

namespace patina {

/// Writes `density` (all layers together) and `density_01_tarnish_1`, … (each) as float grids of class "fog volume" on
/// the volume's lattice, atomically: the part of the voxel that lies between the layer's interface and the one below,
/// 0…1, background 0, only voxels above 0 active. The interfaces are taken as they run between the voxels (trilinear), so
/// that a sum over voxels is the layer's volume (as drawn: exaggerated). A film of a hundredth of a voxel is
/// a density of a hundredth. \param half  written in half precision: three digits \throws RunError where the volume has
/// no layers, or the file cannot be written
void writeFog(const LayerVolume& volume, const std::filesystem::path& path, bool half);

} // namespace patina
