#pragma once
// A ball around a hollow, closed or with a channel.

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <algorithm>
#include <cmath>

namespace patina::test {

/// A ball of radius `radius` around a hollow of radius `hollow`, in voxels, which a channel of half-width `channel`
/// opens upward where that is above 0.
inline std::unique_ptr<Piece> hollowBall(float radius, float hollow, double channel = 0.0, double exteriorBand = 4.0,
                                         int level = 4) {
    SurfaceMesh surface = sphere(radius, level);
    const SurfaceMesh inner = sphere(hollow, 3);
    const int first = static_cast<int>(surface.positions.size());
    for (std::size_t v = 0; v < inner.positions.size(); ++v) {
        surface.positions.push_back(inner.positions[v]);
        surface.normals.push_back(-inner.normals[v]);
    }
    for (const Imath::V3i& t : inner.triangles)
        surface.triangles.emplace_back(t[0] + first, t[2] + first, t[1] + first);
    auto piece = makePiece(std::move(surface), voxelScale(), exteriorBand);
    if (channel > 0.0)
        for (FloatLeaf* leaf : leavesOf(piece->volume->grids().base->tree()))
            for (auto voxel = leaf->beginValueAll(); voxel; ++voxel) {
                const Imath::V3i c = piece->volume->grids().space.place(voxel.getCoord());
                if (c.z > 0)
                    voxel.setValue(std::max(*voxel, static_cast<float>(channel - std::hypot(c.x, c.y))));
            }
    return piece;
}

} // namespace patina::test
