#pragma once
// Whether patches of a surface stand in a ball. Includes OpenVDB: for sources only.

#include "volume/distance_seeds.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace patina {

/// How deep a surface may stand into a ball that touches it elsewhere, voxels: more than the errors of patches on
/// smooth surfaces (0.005), so that a convex body stops no ball. It is the same for the closing by balls of one radius
/// and for the largest ball at a point, which therefore answer alike.
constexpr float contactTolerance = 0.02f;

/// The points of a patch that may touch a ball: its own, and eight on a circle around it of no more than half a voxel.
/// Patches are as far apart as that; further out a bent one may stand out of the surface by more than the tolerance.
/// Between them a ball of r voxels may dip by 0.03 / r voxels. A few points that do not depend on the ball make the
/// distance to the surface an exact one, which a foot on a bent patch is not.
struct ContactPoints {
    std::array<Imath::V3f, 9> at; ///< from the patch's own point

    static constexpr float furthest = 0.5f;
    /// No contact is nearer than `distance` to a point whose squared distance from the patch's own is more than this.
    static float squaredReach(float distance) { return (distance + 1.01f * furthest) * (distance + 1.01f * furthest); }

    explicit ContactPoints(const SurfacePatch& patch);
    /// How far the points of a patch lie from its own, voxels: none where it is sharp.
    static float reachOf(const SurfacePatch& patch);
};

/// Where the contact points of many patches lie at most, as plain arrays: each patch's are within a disc of radius `far`
/// across its normal, `thick` to either side. Tells quickly that they stand clear of a ball.
class ContactBounds {
  public:
    static constexpr int lanes = 8;

    ContactBounds() = default;
    void reserve(std::size_t count);
    void add(const Imath::V3f& point, const SurfacePatch& patch);
    /// Fills up to whole lanes with what stands clear of any ball.
    void pad();
    std::size_t size() const { return x_.size(); }

    /// Of the patches `first` … `first + lanes - 1`, a bit for each with contact points that may be nearer than
    /// `distance` to c.
    unsigned near(std::size_t first, const Imath::V3f& c, float distance) const;

  private:
    std::vector<float> x_, y_, z_, normalX_, normalY_, normalZ_, far_, thick_;
};

/// Asks all patches of a surface that may meet a ball. Immutable; queries are safe from any thread.
class PatchContact {
  public:
    /// \param seeds  must outlive this
    explicit PatchContact(const SurfaceSeeds& seeds);

    /// Whether no contact point is nearer than `distance` to a point, both in voxels, the point from a block's origin.
    /// \param guess  a seed whose patch may be nearer (the last answer), or -1: asked first, to save time. Set to the
    ///               seed that was found
    bool isClear(const openvdb::Coord& block, const Imath::V3f& point, float distance, std::int32_t& guess) const;

  private:
    bool standsIn(std::uint32_t seed, const Imath::V3f& fromSeed, float distance) const;

    const SurfaceSeeds& seeds_;
    std::vector<Imath::Box3f> boxes_; ///< of each block's seeds, in voxels from the block's origin
    std::vector<std::uint32_t> bound_; ///< of each block's first seed, index into bounds_
    ContactBounds bounds_;
};

inline unsigned ContactBounds::near(std::size_t first, const Imath::V3f& c, float distance) const {
    const float reach = distance + 1.01f * ContactPoints::furthest;
    float apart[lanes], along[lanes], out[lanes], least = std::numeric_limits<float>::max();
    for (int l = 0; l < lanes; ++l) {
        const std::size_t i = first + l;
        const float dx = c.x - x_[i], dy = c.y - y_[i], dz = c.z - z_[i];
        apart[l] = dx * dx + dy * dy + dz * dz;
        along[l] = dx * normalX_[i] + dy * normalY_[i] + dz * normalZ_[i];
    }
    for (int l = 0; l < lanes; ++l)
        least = apart[l] < least ? apart[l] : least;
    if (!(least < reach * reach))
        return 0;
    for (int l = 0; l < lanes; ++l) {
        const std::size_t i = first + l;
        const float across2 = apart[l] - along[l] * along[l];
        const float across = std::sqrt(across2 > 0.f ? across2 : 0.f) - far_[i];
        const float side = across > 0.f ? across : 0.f;
        const float height = std::abs(along[l]) - thick_[i];
        const float above = height > 0.f ? height : 0.f;
        out[l] = side * side + above * above;
    }
    unsigned bits = 0;
    for (int l = 0; l < lanes; ++l)
        bits |= unsigned(out[l] < distance * distance) << l;
    return bits;
}

inline float ContactPoints::reachOf(const SurfacePatch& patch) {
    // Beside a sharp convex edge a patch is turned and blunter than the surface, and its circle would stand out of the
    // faces: its own point serves. Bent mostly outwards tells it from the patches beside a concave crease.
    const float bentness = patch.bentness(), outwards = patch.shape[0] + patch.shape[3] + patch.shape[5];
    const bool sharp = !patch.crease && bentness > 0.1f && outwards > 0.5f * bentness;
    return sharp ? 0.f : std::min(patch.reach, furthest);
}

inline ContactPoints::ContactPoints(const SurfacePatch& patch) {
    const float far = reachOf(patch);
    if (patch.crease) {
        const Imath::V3f along(patch.shape[0], patch.shape[1], patch.shape[2]);
        for (int i = 0; i < 9; ++i)
            at[i] = along * (far * 0.25f * float(i - 4));
        return;
    }
    // Two directions across the normal (Duff et al., "Building an orthonormal basis, revisited", 2017).
    const Imath::V3f& n = patch.normal;
    const float sign = std::copysign(1.f, n.z), a = -1.f / (sign + n.z), b = n.x * n.y * a;
    const Imath::V3f u(1.f + sign * n.x * n.x * a, sign * b, -sign * n.x), v(b, sign + n.y * n.y * a, -n.y);
    const Imath::V3f bentU = patch.bend(u);
    const float uu = u.dot(bentU), uv = v.dot(bentU), vv = v.dot(patch.bend(v)), sag = 0.5f * far * far;
    constexpr float c = 0.70710678f;
    at[0] = Imath::V3f(0.f);
    for (int i = 0; i < 2; ++i) {
        const float s = i ? -1.f : 1.f;
        at[1 + i] = u * (s * far) - n * (sag * uu);
        at[3 + i] = v * (s * far) - n * (sag * vv);
        at[5 + i] = (u + v) * (s * far * c) - n * (sag * (0.5f * (uu + vv) + uv));
        at[7 + i] = (u - v) * (s * far * c) - n * (sag * (0.5f * (uu + vv) - uv));
    }
}

} // namespace patina
