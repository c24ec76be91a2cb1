#include "operators/growth/voxel_levels.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {

std::int32_t makeVoxelLevels(LevelOccupancy& occupancy, std::size_t cell, std::int32_t foot, std::int32_t top,
                             double levelVoxels, double phase) {
    double solid = phase;
    for (std::int32_t level = 1; level <= foot; ++level)
        solid += occupancy.holds(cell, level) ? levelVoxels : 0.0;
    double whole = std::floor(solid);
    std::vector<std::int32_t> filled;
    double high = 0.0; // top of the levels gone through
    for (std::int32_t level = 1; level <= top; ++level) {
        const bool isSolid = occupancy.holds(cell, foot + level);
        const double end = level * levelVoxels;
        // The border of two voxels may lie within the level: each takes its part, and no level is higher than a voxel.
        const double border = std::min(end, std::floor(high) + 1.0);
        const auto voxel = static_cast<std::int32_t>(std::floor(high)) + 1;
        const auto add = [&](double part, std::int32_t into) {
            solid += isSolid ? part : 0.0;
            if (solid >= whole + 1.0) {
                whole += 1.0;
                // Rounding may have two whole numbers passed within one voxel.
                filled.push_back(filled.empty() ? into : std::max(into, filled.back() + 1));
            }
        };
        add(border - high, voxel);
        if (end > border)
            add(end - border, voxel + 1);
        high = end;
    }
    occupancy.clear(cell);
    for (const std::int32_t voxel : filled)
        occupancy.add(cell, voxel);
    return filled.empty() ? 0 : filled.back();
}

} // namespace patina
