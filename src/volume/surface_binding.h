#pragma once
// Which point of the model's surface each voxel of the band belongs to: what maps are asked at.

#include "surface/ray_scene.h"
#include "volume/layer_volume.h"
#include "volume/sheet_back.h"

#include <limits>
#include <vector>

namespace patina {

/// The closest point of the model for every active voxel, in the order of the base's leaves and active voxels.
/// Voxels whose closest point lies on the back that a sheet was given belong to no point (triangle -1).
class SurfaceBinding {
  public:
    /// `closed` must be what the volume was voxelised from and `surface` what it was made of.
    SurfaceBinding(const LayerVolume& volume, const SurfaceMesh& surface, const ClosedSurface& closed);

    /// Recomputes the closest points, needed after the band has grown.
    void rebind(const LayerVolume& volume);

    /// Gives phi_0 the exact distances to the model in the whole band, signs kept: the voxeliser's own are exact next to the surface only.
    /// For volumes without layers.
    void refineBase(LayerVolume& volume) const;

    const SurfaceMesh& surface() const { return *surface_; }
    /// Index of the first active voxel of leaf n.
    std::size_t leafStart(std::size_t n) const { return leafStart_[n]; }
    const SurfacePoint& at(std::size_t index) const { return points_[index]; }

    /// The closest point to any position (scene units); triangle -1 on the back.
    /// `radius` (scene units) is a guess at the distance that makes the search short; a wrong one costs time only.
    SurfacePoint closest(const Imath::V3d& position,
                         float radius = std::numeric_limits<float>::infinity()) const;

    /// Whether the model itself is in the way of a ray to infinity.
    bool occluded(const Imath::V3f& origin, const Imath::V3f& direction) const;

  private:
    const SurfaceMesh* surface_;
    RayScene scene_;
    std::size_t frontTriangles_;
    std::vector<std::size_t> leafStart_;
    std::vector<SurfacePoint> points_;
};

} // namespace patina
