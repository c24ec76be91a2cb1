#pragma once
// Accessibility (G. Miller, "Efficient algorithms for local and global accessibility shading", SIGGRAPH 1994): the
// radius of the largest sphere that touches a point of the surface from outside without cutting the surface anywhere.

#include "base/progress.h"
#include "operators/fields/surface_voxels.h"

#include <vector>

namespace patina {

/// | place                                              | A                                            |
/// | -------------------------------------------------- | -------------------------------------------- |
/// | plane, convex body                                 | as large as asked for                        |
/// | inside a sphere or cylinder of radius R            | R                                            |
/// | gap of width w                                     | w / 2                                        |
/// | V-groove of full angle 2φ, at s from its apex      | s tan φ                                      |
///
/// On a sharp convex edge the sphere may lean between the normals of the two faces.
///
/// \param surface  findSurfaceVoxels() of the same volume and layer
/// \param layer    volume.layerCount(): the surface as it is now, layers included
/// \param limitVoxels  largest radius of interest, > 0
/// \param global   the sphere must also be able to come from outside: from where it lies it can be rolled, or shrunk
///                 and then no further, out of the model's bounds without cutting the surface
/// \return the radius of each surface voxel's foot, voxels, at most the limit
/// \throws Interrupted
std::vector<float> accessibleRadii(const LayerVolume& volume, const SurfaceVoxels& surface, int layer,
                                   double limitVoxels, bool global, Progress& progress);

} // namespace patina
