#pragma once
// The points of a surface that may touch a ball. Includes OpenVDB: for sources only.

#include "volume/distance_seeds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace patina {

/// How deep a surface may stand into a ball that touches it elsewhere, voxels: more than the errors of patches on
/// smooth surfaces (0.005), so that a convex body stops no ball. It is the same for the closing by balls of one radius
/// and for the largest ball at a point, which therefore answer alike.
constexpr float contactTolerance = 0.02f;

/// The points of each patch that may touch a ball: its own, and eight on a circle around it of no more than half a
/// voxel (of a piece of an edge, nine along it). Patches are as far apart as that. Between them a ball of r voxels may
/// dip by 0.03 / r voxels. A few points that do not depend on the ball make the distance to the surface an exact one,
/// which a foot on a bent patch is not.
///
/// No point stands out of the level set: beside an edge a patch may be turned or blunter than the surface, or go on
/// beyond it, so each point on its circle is lowered onto the trilinear zero set where that is below, and left out
/// where that is far below.
class SurfaceContacts {
  public:
    using Points = std::array<Imath::V3f, 9>;
    static constexpr float furthest = 0.5f; ///< from the patch's own point, voxels

    /// \param seeds  of this level set; must outlive this \param voxelSize  scene units
    SurfaceContacts(const LevelSetBlocks& levelSet, const SurfaceSeeds& seeds, double voxelSize);

    const SurfaceSeeds& seeds() const { return seeds_; }
    /// From the patch's own point.
    Points of(std::size_t seed) const;
    /// How far a patch's points lie from its own across its normal, and along it, voxels.
    float reachOf(std::size_t seed) const { return std::min(seeds_.patches[seed].reach, furthest); }
    float heightOf(std::size_t seed) const;

  private:
    const SurfaceSeeds& seeds_;
    std::vector<std::array<float, 8>> heights_; ///< of each point on the circle along the normal; `none` where left out
};

namespace contacts {

constexpr float none = -9.f;

/// Two directions across a normal (Duff et al., "Building an orthonormal basis, revisited", 2017).
struct Across {
    Imath::V3f u, v;
    explicit Across(const Imath::V3f& n) {
        const float sign = std::copysign(1.f, n.z), a = -1.f / (sign + n.z), b = n.x * n.y * a;
        u = {1.f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        v = {b, sign + n.y * n.y * a, -n.y};
    }
    /// Point i of eight on the unit circle.
    Imath::V3f onCircle(int i) const {
        constexpr float c = 0.70710678f;
        static constexpr float x[8] = {1.f, -1.f, 0.f, 0.f, c, -c, c, -c}, y[8] = {0.f, 0.f, 1.f, -1.f, c, -c, -c, c};
        return u * x[i] + v * y[i];
    }
};

} // namespace contacts

inline SurfaceContacts::Points SurfaceContacts::of(std::size_t seed) const {
    const SurfacePatch& patch = seeds_.patches[seed];
    const float far = reachOf(seed);
    Points at;
    if (patch.crease) {
        const Imath::V3f along(patch.shape[0], patch.shape[1], patch.shape[2]);
        for (int i = 0; i < 9; ++i)
            at[i] = along * (far * 0.25f * float(i - 4));
        return at;
    }
    const contacts::Across across(patch.normal);
    at[8] = Imath::V3f(0.f);
    for (int i = 0; i < 8; ++i) {
        const float height = heights_[seed][i];
        at[i] = height == contacts::none ? Imath::V3f(0.f) : across.onCircle(i) * far + patch.normal * height;
    }
    return at;
}

} // namespace patina
