#pragma once
// How a surface lies in its UVs: derivatives, and the frames that tangent-space maps are written in.

#include "surface/mesh.h"

#include <cstdint>
#include <vector>

namespace patina {

/// dP/du and dP/dv of a triangle, scene units per UV unit, and likewise of its interpolated normal.
struct UvDerivatives {
    Imath::V3d du, dv;
    Imath::V3d normalDu, normalDv;
    bool valid = false; ///< not where the UVs have no area; all are zero then
    bool mirrored = false; ///< the UVs run clockwise
};

UvDerivatives uvDerivativesOf(const SurfaceMesh& surface, int triangle);

/// The tangents that renderers use (MikkTSpace's rule): at each vertex the mean of dP/du, by angle, over the triangles
/// that share the vertex, its UV and their orientation, each turned into the plane of the normal first. On a finely diced
/// limit surface they tend to the limit's own derivatives. Triangles without an area in the UVs do not count; where only
/// such meet, any direction stands in. \throws nothing; needs UVs. Safe from any thread.
class TangentFrames {
  public:
    explicit TangentFrames(const SurfaceMesh& surface);

    struct Frame {
        Imath::V3d tangent, bitangent, normal; ///< unit; the bitangent on the side to which v runs
    };
    /// At a point of a triangle, all at right angles; `normal` is the frame's, unit.
    Frame at(const SurfacePoint& point, const Imath::V3d& normal) const;
    /// With the tangent as renderers interpolate it between the vertices, where it is not quite at right angles to the
    /// normal.
    Frame interpolatedAt(const SurfacePoint& point, const Imath::V3d& normal) const;

  private:
    Imath::V3d tangentAt(const SurfacePoint& point, const Imath::V3d& normal) const;

    std::vector<Imath::V3i> corners_;
    std::vector<Imath::V3f> tangents_;
    std::vector<std::uint8_t> mirrored_;
};

} // namespace patina
