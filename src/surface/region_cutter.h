#pragma once
// The part of a model near a box, as fine as asked for, whatever the size of the model.

#include "surface/limit_surface.h"
#include "surface/mesh.h"

#include <Imath/ImathBox.h>

namespace patina {

/// Finds and refines what lies near a box. Cages are subdivided step by step and everything away from the box is left
/// behind after each step, so that time and memory go with the surface in the box and not with the model.
class RegionCutter {
  public:
    /// \param mesh     must outlive this
    /// \param options  scheme and level as for makeLimitSurface(); its targetEdge is not used
    /// \throws ModelError as makeLimitSurface() does
    RegionCutter(const Mesh& mesh, const LimitSurfaceOptions& options);

    /// The whole model: a scan as it is, a cage's limit surface with edges of about 1/128 of its longest side.
    const SurfaceMesh& whole() const { return whole_; }
    /// Whether the model is a cage that stands for its limit surface.
    bool isSubdivided() const { return scheme_ != SubdivisionScheme::none; }
    double longestSide() const { return longestSide_; }

    /// The triangles that meet the box (model coordinates, scene units), whole and not cut, with vertices relative to
    /// `origin`, UVs and attributes as the model's. Scans keep their vertices (with an origin of 0 to the bit) and
    /// their normals in the whole; of cages half of the edges are no longer than targetEdge, unless the options fix
    /// the level. `closed` is the whole model's. Without triangles where nothing meets the box.
    SurfaceMesh near(const Imath::Box3d& box, const Imath::V3d& origin, double targetEdge) const;

  private:
    const Mesh& mesh_;
    SubdivisionScheme scheme_ = SubdivisionScheme::none;
    int level_ = -1;
    SurfaceMesh whole_;
    double longestSide_ = 0.0;
};

/// The edge at which whole() of a cage is cut fine: 1/128 of the longest side.
inline constexpr double wholeEdgesPerSide = 128.0;

} // namespace patina
