#pragma once
// The largest sphere that touches a point of a surface from outside, against the surface as patches.

#include <Imath/ImathVec.h>

#include <memory>

namespace patina {

class IndexSpace;
class SurfaceContacts;

/// A sphere of radius r that touches p along the unit normal n holds a point q, with d = q - p, where r > d² / 2 n·d.
/// So the largest empty one is 1 / 2k with k = max n·d / d² over all q (an inversion about p turns spheres through p
/// into planes, and q into a point at height k). As radii shrink the spheres nest, so what lies outside one lies
/// outside all that follow: one walk over the blocks that the sphere still meets finds the answer.
///
/// The surface is the contact points of all patches (volume/surface_contacts.h). They may stand into the sphere by t =
/// contactTolerance: k = (n·d - t) / (d² - t²). With D the distance to the nearest of them, the answer is the largest A
/// with D(p + A n) >= A - t; and since D(p + r n) - r never grows with r, every smaller r passes the same test and no
/// larger one does.
///
/// Immutable; queries are safe from any thread.
class TangentSpheres {
  public:
    /// \param contacts  must outlive this
    /// \param space  of the grid that they are of
    TangentSpheres(const SurfaceContacts& contacts, const IndexSpace& space);
    ~TangentSpheres();
    TangentSpheres(TangentSpheres&&) noexcept;

    struct Touch {
        float radius = 0.f; ///< voxels, at most the limit
        int seed = -1;      ///< number of the seed whose patch stops it; -1 where nothing does
    };

    /// \param p  a point of the surface, voxels; `n` its outward unit normal
    /// \param limit  largest radius of interest, voxels
    /// \param guess  a seed that may stop the sphere (such as the neighbour's): saves time
    Touch largest(const Imath::V3f& p, const Imath::V3f& n, float limit, int guess = -1) const;

  private:
    struct Blocks;
    std::unique_ptr<const Blocks> blocks_;
};

} // namespace patina
