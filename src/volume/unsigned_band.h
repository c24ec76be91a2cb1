#pragma once
// The band of voxels around a surface, by OpenVDB's mesh-to-volume; both voxelisers start with it. Includes OpenVDB: for
// sources of volume/ only.

#include "base/progress.h"
#include "volume/grid_instances.h"
#include "volume/sheet_back.h"

namespace patina {

/// Active voxels within `width` voxels of the surface, with their distance to it, scene units; no signs: the library's own
/// take for metal whatever the outside cannot reach. Voxels are centred on whole multiples of voxelSize (scene
/// units); the grid's transform says where among them it lies (see IndexSpace and indexOriginFor()).
/// Empty where the surface has no triangles; what there is when progress is cancelled.
openvdb::FloatGrid::Ptr unsignedBand(const ClosedSurface& surface, double voxelSize, float width, Progress& progress);

} // namespace patina
