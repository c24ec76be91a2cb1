#pragma once
// The voxels' own surface, ready to be shown: where it lies, how it is shaded, and which point of the model's surface
// carries the stack that is seen there.

#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <functional>

namespace patina {

struct VoxelSurface {
    SurfaceMesh shown; ///< the interface to the air, scene units of the volume
    SurfaceMesh under; ///< for each vertex of it a point of the model's surface with its normal; the same triangles
};

/// The zero set of the outermost interface. Its normals are the model's, tilted as the interface is against the base:
/// facets and voxels are no more seen than in the displaced mesh. Where surfaces face each other within a voxel, each
/// side keeps to its own half of the model.
/// \param split  splits the voxels' triangles, which are as wide as a voxel; what it returns is moved onto the zero set
///             of the field between the lattice points. Empty: they are shown as they are
/// \throws RunError where the interface crosses no voxel
VoxelSurface voxelSurface(const LayerVolume& volume, const SurfaceMesh& model,
                          const std::function<SurfaceMesh(const SurfaceMesh&)>& split = {});

} // namespace patina
