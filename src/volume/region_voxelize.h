#pragma once
// The base level set of a region: voxels of the box only, signs of the whole model.

#include "base/progress.h"
#include "surface/ray_scene.h"
#include "volume/region.h"
#include "volume/voxelize.h"

namespace patina {

/// Makes a piece of a closed model say truly which side is metal: triangles that the whole model wraps inside out are
/// turned round, those with metal (or air) on both sides are dropped. Both sides of every triangle are asked, a quarter
/// of a voxel away, by rays through the whole model: metal is where the crossings, counted with their direction, do not
/// cancel. \param whole  in the piece's coordinates
void settleSides(SurfaceMesh& piece, const RayScene& whole, double voxelSize);

/// Whether a point is in the metal, by the same count.
bool isInside(const RayScene& whole, const Imath::V3f& point);

/// As voxelize(), for the piece of surface around a region, in the region's coordinates: exact distances in the band
/// within the region's voxel box; beyond it no voxel is active, and inside and outside go on as they are: there is no
/// wall at the sides. \throws ModelError where no voxel is inside
LayerVolume voxelizeRegion(const ClosedSurface& piece, const Region& region, const VoxelizeOptions& options,
                           Progress& progress);

} // namespace patina
