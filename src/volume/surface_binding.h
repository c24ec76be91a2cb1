#pragma once
// Which point of the model's surface each voxel of the band belongs to: what maps are asked at.

#include "surface/ray_scene.h"
#include "volume/layer_volume.h"
#include "volume/sheet_back.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace patina {

/// The closest point of the model for every active voxel, in the order of the base's leaves and active voxels.
/// Voxels whose closest point lies on the back that a sheet was given belong to no point (triangle -1); those under its
/// rim, down to two voxels below the sheet's edge, to the edge, so that a film reaches it and ends there everywhere alike.
/// Faces buried inside other parts of the model (metal on both their sides) are no surface: no voxel belongs to them.
class SurfaceBinding {
  public:
    /// `closed` must be what the volume was voxelised from and `surface`, which must outlive this, what it was made of.
    SurfaceBinding(const LayerVolume& volume, const SurfaceMesh& surface, ClosedSurface closed);

    /// Finds the closest points of the voxels that have come to the band since; needed after it has grown.
    void rebind(const LayerVolume& volume);

    /// Gives phi_0 the exact distances to the model in the whole band, signs kept: the voxeliser's own are exact next
    /// to the surface only, and count buried faces. Voxels that turn out to lie deeper than the band leave it. For
    /// volumes without layers.
    void refineBase(LayerVolume& volume);

    const SurfaceMesh& surface() const { return *surface_; }
    /// Whether some of the closed surface is no part of the model (the back of a sheet).
    bool hasBack() const { return closed_.frontTriangles < closed_.triangles.size(); }
    /// Index of the first active voxel of leaf n.
    std::size_t leafStart(std::size_t n) const { return leafStart_[n]; }
    const SurfacePoint& at(std::size_t index) const { return points_[index]; }
    /// Those of leaf n's active voxels, one after the other.
    const SurfacePoint* pointsOf(std::size_t n) const { return points_.data() + leafStart_[n]; }

    /// The closest point to any position (scene units), or that of the edge above the rim; triangle -1 on the back.
    /// `radius` (scene units) is a guess at the distance that makes the search short; a wrong one costs time only.
    /// Beyond `widest` nothing is found (triangle -1).
    SurfacePoint closest(const Imath::V3d& position, float radius = std::numeric_limits<float>::infinity(),
                         float widest = std::numeric_limits<float>::infinity()) const;

    /// Whether what is closest to a position is the back or the rim of a sheet.
    bool behind(const Imath::V3d& position) const;

    /// Whether the model itself is in the way of a ray to infinity.
    bool occluded(const Imath::V3f& origin, const Imath::V3f& direction) const;
    /// Where a ray first meets the model, if it does up to `farthest` lengths of `direction`.
    std::optional<RayScene::FaceHit> firstHit(const Imath::V3f& origin, const Imath::V3f& direction,
                                              float farthest) const;

  private:
    bool findVisible(const LayerVolume& volume); ///< whether that is other than before
    SurfacePoint edgeAbove(const SurfacePoint& onRim) const; ///< triangle -1 where it is too far, or not on the rim
    void countVoxels(const LayerVolume& volume); ///< into leafStart_

    const SurfaceMesh* surface_;
    ClosedSurface closed_;
    double rimReach_; ///< scene units
    /// A piece of a large triangle of which other pieces are buried.
    struct Piece {
        Imath::V2f corners[3]; ///< u, v in its triangle
    };
    std::vector<int> visible_;      ///< triangles of closed_ that are surface, in order; then those of the pieces
    std::vector<Piece> pieces_;     ///< of the last visible ones
    std::optional<RayScene> scene_; ///< of the visible triangles
    std::vector<std::size_t> leafStart_;
    /// The active voxels of a leaf, bit by bit.
    struct LeafVoxels {
        std::array<std::int32_t, 3> origin;
        std::array<std::uint64_t, 8> active;
    };
    std::vector<LeafVoxels> leafVoxels_; ///< whose points these are
    std::vector<SurfacePoint> points_;
};

} // namespace patina
