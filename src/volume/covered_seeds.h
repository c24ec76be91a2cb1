#pragma once
// Over which seeds of a surface its closing lies. Includes OpenVDB: for sources only.

#include "base/progress.h"
#include "volume/closing_balls.h"
#include "volume/distance.h"

#include <cstdint>
#include <vector>

namespace patina {

/// For every seed whether the closing lies above it: a ball that should touch it, or the foot of a surface voxel on its
/// patch, does not. Films beside sharp convex edges count only where they are connected to one that is surely there.
/// \param nearestBall  of balls.centres() \param radius  voxels \throws Interrupted
std::vector<std::uint8_t> coveredSeeds(const DistanceTransform& surface, const ClosingBalls& balls,
                                       const NearestPoints& nearestBall, float radius, double voxelSize,
                                       Progress& progress);

/// The marked seeds and those in the cells around them.
std::vector<std::uint8_t> withNeighbours(const PointBlocks& points, const std::vector<std::uint8_t>& marks);

} // namespace patina
