#pragma once
// A level set's zero set as small curved patches, one in each lattice cell that it crosses. Includes OpenVDB: for
// sources only.

#include "volume/distance_points.h"
#include "volume/level_set_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace patina {

/// A piece of surface around a point: x(u) = point + u - (u·S u)/2 normal, for u in the tangent plane.
struct SurfacePatch {
    Imath::V3f normal;          ///< outward, unit
    std::array<float, 6> shape; ///< S: curvatures (1/voxel) as a symmetric matrix xx xy xz yy yz zz; convex: positive

    /// A piece of a sharp edge instead: S holds its direction (xx xy xz), zero in a corner, and the normal of one of its
    /// two faces (yy yz zz); `normal` lies in the middle between both.
    bool crease = false;
    bool convex = false; ///< of a crease: it stands out of the surface
    /// How far the patch reaches from its point, in voxels: a little further than half the way to the next; less where
    /// it is so curved that a parabola says little about it (edges).
    float reach;
    static constexpr float furthestReach = 0.9f, furthestBend = 0.4f;

    /// The size of S: its two curvatures' root of squares, 1/voxel.
    float bentness() const {
        return std::sqrt(shape[0] * shape[0] + shape[3] * shape[3] + shape[5] * shape[5] +
                         2.f * (shape[1] * shape[1] + shape[2] * shape[2] + shape[4] * shape[4]));
    }

    Imath::V3f bend(const Imath::V3f& u) const {
        return {shape[0] * u.x + shape[1] * u.y + shape[2] * u.z, shape[1] * u.x + shape[3] * u.y + shape[4] * u.z,
                shape[2] * u.x + shape[4] * u.y + shape[5] * u.z};
    }

    /// The point of the patch that is closest to `w`; both are measured from the patch's own point.
    Imath::V3f foot(const Imath::V3f& w) const;

    /// Outward unit normal at a foot, not of a crease.
    Imath::V3f normalAt(const Imath::V3f& foot) const {
        return (normal + bend(foot - normal * foot.dot(normal))).normalized();
    }
};

/// A point of a surface, in voxels, and where to balls that touch it there may lie: along the outward unit normal; at a
/// convex edge anywhere between the normals of its faces, of which the middle and both ends are tried.
struct TouchPoint {
    Imath::V3f foot;
    std::array<Imath::V3f, 3> normals;
    int count = 1; ///< of normals
};

/// The zero set of a level set: points on it, one for each cell it crosses, and the patch around each.
struct SurfaceSeeds {
    PointBlocks points;
    std::vector<SurfacePatch> patches;

    /// The point of a seed's patch that is closest to x; both in voxels from a block's origin.
    Imath::V3f footOf(const openvdb::Coord& block, const Imath::V3f& x, std::int32_t seed) const {
        const Imath::V3f s = points.from(block, seed);
        return s + patches[seed].foot(x - s);
    }
    TouchPoint pointUnder(const openvdb::Coord& block, const Imath::V3f& x, std::int32_t seed) const {
        const SurfacePatch& patch = patches[seed];
        const Imath::V3f s = points.from(block, seed), foot = patch.foot(x - s);
        TouchPoint point{s + foot, {patch.crease ? patch.normal : patch.normalAt(foot)}};
        if (patch.crease && patch.convex) {
            const Imath::V3f face(patch.shape[3], patch.shape[4], patch.shape[5]);
            point.normals[1] = face;
            point.normals[2] = patch.normal * (2.f * face.dot(patch.normal)) - face;
            point.count = face.dot(face) > 0.f ? 3 : 1;
        }
        return point;
    }
};

/// Seeds on the set where the level set's trilinear interpolant is `iso` (scene units). Seeds are in the order of the
/// grid's leaves and cells. \param voxelSize  scene units
SurfaceSeeds makeSurfaceSeeds(const LevelSetBlocks& levelSet, double voxelSize, double iso = 0.0);

/// The points alone, of the zero set, without `blockOf`: 12 bytes each instead of 60, for surfaces that fill their
/// volume. A point lies within its cell, never on the side to the next.
/// \param wanted  for each leaf the cells (by their first corner, numbered as voxels) that may have a point; null: all
PointBlocks makeSurfacePoints(const LevelSetBlocks& levelSet, double voxelSize,
                              const std::vector<std::array<std::uint64_t, 8>>* wanted = nullptr);

inline Imath::V3f SurfacePatch::foot(const Imath::V3f& w) const {
    if (crease) {
        const Imath::V3f along(shape[0], shape[1], shape[2]);
        return along * std::min(reach, std::max(-reach, w.dot(along)));
    }
    const float height = w.dot(normal);
    const Imath::V3f across = w - normal * height;
    // At the foot u the normal is n + S u, so that across = u + height S u in first order: solve (1 + height S) u =
    // across. Where a concave patch lies beyond its own centre of curvature that has no sense; u = across serves.
    const float a = 1.f + height * shape[0], b = height * shape[1], c = height * shape[2], d = 1.f + height * shape[3],
                e = height * shape[4], f = 1.f + height * shape[5];
    const float A = d * f - e * e, B = c * e - b * f, C = b * e - c * d;
    const float determinant = a * A + b * B + c * C;
    const bool regular = determinant > 0.1f && a * d - b * b > 0.05f && a > 0.05f;
    const float inverse = 1.f / (regular ? determinant : 1.f);
    const float D = a * f - c * c, E = b * c - a * e, F = a * d - b * b;
    Imath::V3f u((A * across.x + B * across.y + C * across.z) * inverse,
                 (B * across.x + D * across.y + E * across.z) * inverse,
                 (C * across.x + E * across.y + F * across.z) * inverse);
    if (!regular)
        u = across;
    const float length2 = u.dot(u);
    if (length2 > reach * reach)
        u *= reach / std::sqrt(length2);
    return u - normal * (0.5f * u.dot(bend(u)));
}

} // namespace patina
