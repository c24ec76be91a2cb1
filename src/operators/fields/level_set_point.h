#pragma once
// Points on an interface of the nest. Includes OpenVDB through the sampler: for sources of operators/ only.

#include "volume/nest_sampler.h"

namespace patina {

/// The closest point of phi_k's zero set to x, in voxels, sought from `foot`: Newton steps along the gradient bring it
/// onto the surface, tangential ones under x. \return whether the result lies on the surface to 0.01 voxel
bool levelSetFoot(const NestSampler& sampler, int k, double voxelSize, const Imath::V3d& x, Imath::V3d& foot);

/// The outward unit normal of phi_k at a point, in voxels: differences over one voxel centred at the point. Over that
/// distance the errors of trilinear interpolation cancel, so that the normal of a sphere of radius R voxels is right
/// to 1/R², where the gradient within the cell errs by 1/2R.
Imath::V3d levelSetNormal(const NestSampler& sampler, int k, const Imath::V3d& point);

} // namespace patina
