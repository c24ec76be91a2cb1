#pragma once
// Straight walks on a surface, over the seams of its UVs.

#include "surface/mesh.h"

#include <vector>

namespace patina {

/// Where on the surface a point lies that is given beside another one, in the plane of its triangle: on a triangle that
/// the line meets next it goes on as if the two were turned into one plane. Vertices at one place count as one, so that
/// meshes which are cut along their seams hold together. Keeps a reference to the surface; safe from any thread.
class SurfaceWalk {
  public:
    explicit SurfaceWalk(const SurfaceMesh& surface);

    /// \param displacement  scene units, in the plane of `from.triangle` (what sticks out of it is dropped)
    /// \return the end of the walk. It ends early at an open edge, on a triangle without an area, after 64 triangles.
    SurfacePoint from(SurfacePoint start, Imath::V3d displacement) const;

    /// The triangle behind edge `edge` (corners edge and edge + 1) times 3, plus which of its edges that is; -1 where the
    /// surface is open.
    int behind(int triangle, int edge) const { return behind_[3 * static_cast<std::size_t>(triangle) + edge]; }

    const SurfaceMesh& surface() const { return surface_; }

  private:
    const SurfaceMesh& surface_;
    std::vector<int> behind_;
};

} // namespace patina
