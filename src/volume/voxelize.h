#pragma once
// From a surface to the base level set phi_0 (OpenVDB's mesh-to-volume). Its distances are exact next to the surface;
// SurfaceBinding::refineBase() makes them so in the whole band.

#include "base/progress.h"
#include "volume/layer_volume.h"
#include "volume/sheet_back.h"

namespace patina {

struct VoxelizeOptions {
    VolumeScale scale;
    double interiorBand = 4.0; ///< voxels
    double exteriorBand = 4.0; ///< voxels; the thickest stack plus three is enough for a whole script
    std::string metal = "copper";
};

/// Voxels that the thickness of a sheet's back takes.
inline constexpr double sheetBackVoxels = 8.0;

/// The lattice is anchored at the model's origin: voxel (i, j, k) is centred on (i, j, k) · voxelSize.
/// The material IDs are those of bare metal.
/// \throws ModelError where nothing is inside at this voxel size.
LayerVolume voxelize(const ClosedSurface& surface, const VoxelizeOptions& options, Progress& progress);

} // namespace patina
