#pragma once
// Columns of particles lower than a voxel, as voxels can hold them.

#include "operators/growth/level_occupancy.h"

#include <cstdint>

namespace patina {

/// Makes levels of one voxel out of a column's thinner ones, in place. A voxel is solid where the solid below its top
/// passes the next whole number of voxels: the column keeps its solid to within a voxel, its pores keep their share at
/// every height, and over columns of even phases nothing is lost or won. Sampled at voxel centres instead, layers of
/// levels of 0.42 voxel were 5 per cent too thin. \param foot   level on which the column begins; what is below counts
/// only for how full the first voxel is \param top    highest filled level, counted from the foot \param levelVoxels
/// thickness of a level, above 0 and below 1 \param phase  0 <= phase < 1: solid that is there at the start \return the
/// highest solid voxel, counted from the foot as all of the new ones are; 0: none
std::int32_t makeVoxelLevels(LevelOccupancy& occupancy, std::size_t cell, std::int32_t foot, std::int32_t top,
                             double levelVoxels, double phase);

} // namespace patina
