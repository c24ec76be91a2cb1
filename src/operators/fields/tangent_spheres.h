#pragma once
// The largest sphere that touches a point of a surface from outside, against the surface as a cloud of points.

#include <Imath/ImathVec.h>

#include <memory>
#include <vector>

namespace patina {

/// A sphere of radius r that touches p along the unit normal n holds a point q, with d = q - p, where r > d² / 2 n·d.
/// So the largest empty one is 1 / 2k with k = max n·d / d² over all q (an inversion about p turns spheres through p
/// into planes, and q into a point at height k). As radii shrink the spheres nest, so what lies outside one lies
/// outside all that follow: one walk over the blocks that the sphere still meets finds the answer.
///
/// Points may stand into the sphere by `tolerance`: k = (n·d - tolerance) / (d² - tolerance²).
///
/// Within `nearby` of p the noise of points and normals (which turn within a voxel or two at an edge) would count as a
/// wall, so there the surface is asked from both ends: h = n·d is the height of q over p's tangent plane, h' = -m·d
/// that of p over q's, with m the normal at q. Where one sphere touches both they are equal. h + h' <= 0 means a convex
/// surface, where q stops nothing; else their mean is used, which cancels errors of the normals; in a sharp crease,
/// h + h' > |d| / 2, where p may lie in q's plane and yet be stuck, h itself.
///
/// Immutable; queries are safe from any thread.
class TangentSpheres {
  public:
    /// \param points  of the surface, in voxels, about one per voxel or denser; `normals` outward, unit
    TangentSpheres(const std::vector<Imath::V3f>& points, const std::vector<Imath::V3f>& normals);
    ~TangentSpheres();
    TangentSpheres(TangentSpheres&&) noexcept;

    /// How deep points may stand into the sphere, voxels: more than the noise of points and normals (about 0.005), less
    /// than the film of an offset that is dropped (0.02).
    static constexpr float tolerance = 0.01f;
    static constexpr float nearby = 3.f; ///< voxels

    struct Touch {
        float radius = 0.f; ///< voxels, at most the limit
        int point = -1;     ///< index of what stops it; -1 where nothing does
    };

    /// \param limit  largest radius of interest, voxels
    /// \param guess  a point that may stop the sphere (such as the neighbour's): saves time, does not change the result
    Touch largest(const Imath::V3f& p, const Imath::V3f& n, float limit, int guess = -1) const;

    /// The radius that a point of the surface, with its normal m, leaves to a sphere at p; infinity where it stops
    /// none.
    static float radiusAt(const Imath::V3f& p, const Imath::V3f& n, const Imath::V3f& q, const Imath::V3f& m);

  private:
    struct Blocks;
    std::unique_ptr<const Blocks> blocks_;
};

} // namespace patina
