#pragma once
// Rain that runs down the surface.

#include "operators/fields/surface_voxels.h"

namespace patina {

struct Drainage {
    std::vector<float> passing;  ///< water that arrives from above, in voxels of level ground rained on
    std::vector<float> retained; ///< 0 … 1: how much of what comes by finds no way down (a hollow)
};

/// One sweep over the surface voxels from the highest to the lowest. Each hands on what it has, its own rain included,
/// to those of its 26 neighbours that lie lower along its slope, more to those straight down it (multiple flow
/// directions: T. G. Freeman, Computers & Geosciences 17, 1991). Under overhangs the water lets go: from 20° past the
/// vertical on, and all of it where the surface looks down.
/// \param up    unit
/// \param rain  what falls on each surface voxel, 0 … 1
Drainage drain(const SurfaceVoxels& surface, const Imath::V3d& up, const std::vector<float>& rain);

} // namespace patina
