#pragma once
// Volumes whose base is an exact distance field given by a formula, and some formulas. Lengths in voxels.

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <cmath>
#include <functional>
#include <memory>

namespace patina::test {

using Distance = std::function<double(const Imath::V3d&)>;

/// Bare metal around the origin, in a cube of +-half voxels, with a band of `inner` and `outer` voxels.
inline LayerVolume volumeOf(const Distance& distance, int half, double inner = 4.0, double outer = 4.0) {
    initializeVolumes();
    auto grids = std::make_unique<NestGrids>();
    grids->base = openvdb::FloatGrid::create(static_cast<float>(outer));
    grids->base->setGridClass(openvdb::GRID_LEVEL_SET);
    auto accessor = grids->base->getAccessor();
    for (int i = -half; i <= half; ++i)
        for (int j = -half; j <= half; ++j)
            for (int k = -half; k <= half; ++k) {
                const double d = distance({double(i), double(j), double(k)});
                if (d > -inner && d < outer)
                    accessor.setValue({i, j, k}, static_cast<float>(d));
                else if (d <= 0.0)
                    accessor.setValueOff({i, j, k}, static_cast<float>(-outer));
            }
    grids->base->pruneGrid();
    grids->material = openvdb::Int32Grid::create(
        std::make_shared<openvdb::Int32Tree>(grids->base->tree(), 0, openvdb::TopologyCopy()));
    grids->interiorBand = inner;
    grids->exteriorBand = outer;
    return LayerVolume(voxelScale(), "copper", std::move(grids));
}

/// Turned by an angle about two axes.
inline Imath::V3d turned(const Imath::V3d& p, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const Imath::V3d q(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    return {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
}

inline double boxDistance(const Imath::V3d& p, const Imath::V3d& half) {
    const Imath::V3d q(std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z);
    const Imath::V3d out(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0));
    return out.length() + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

inline double torusDistance(const Imath::V3d& p, double large, double small) {
    return std::hypot(std::hypot(p.x, p.y) - large, p.z) - small;
}

/// A block (half sizes) with a V-groove along y in its top, apex on the z axis `depth` below the top.
inline double grooveDistance(const Imath::V3d& p, const Imath::V3d& half, double depth, double halfAngle) {
    // In the cross-section: outside is the union of the outside of the box and the wedge above the apex. The distance
    // to the walls is the box's, or the wedge's.
    const double x = std::abs(p.x), z = p.z - (half.z - depth);
    const double s = std::sin(halfAngle), c = std::cos(halfAngle), width = depth * s / c;
    const double wall = x * c - z * s; // > 0 in the metal, < 0 in the wedge, where the wall continues
    const double along = x * s + z * c, length = depth / c;
    const double onWall = std::clamp(along, 0.0, length);
    const double toWall = std::hypot(x - onWall * s, z - onWall * c); // to the wall as a segment
    const double box = boxDistance(p, half);
    if (p.z <= half.z && z > 0.0 && wall < 0.0 && std::abs(p.y) <= half.y)
        return toWall; // within the groove
    if (box <= 0.0) { // in the metal: the box's sides without the groove's opening, or the wall
        const double q = std::max({x - half.x, std::abs(p.y) - half.y, -p.z - half.z});
        const double top = x >= width ? p.z - half.z : -std::hypot(x - width, p.z - half.z);
        return std::max({q, top, -toWall});
    }
    if (x < width && p.z > half.z && std::abs(p.y) <= half.y) // above the opening: its rims
        return std::min(toWall, std::hypot(x - width, p.z - half.z));
    return box;
}

} // namespace patina::test
