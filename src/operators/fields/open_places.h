#pragma once
// Where rays leave the surface: the triangles themselves over the voxels' feet.

#include "operators/fields/surface_voxels.h"
#include "surface/ray_scene.h"

#include <functional>
#include <optional>

namespace patina {

/// Whether something is in the way from an origin to infinity, scene units.
using Occlusion = std::function<bool(const Imath::V3f& origin, const Imath::V3f& direction)>;

/// What rays meet: the triangles of the surface, or of the whole model around it.
struct Obstacles {
    Occlusion occluded;
    /// The first hit, if there is one up to `farthest` lengths of `direction`.
    std::function<std::optional<RayScene::FaceHit>(const Imath::V3f& origin, const Imath::V3f& direction,
                                                   float farthest)>
        first;

    static Obstacles of(const RayScene& scene); ///< which must outlive them
};

/// One for each surface voxel.
struct OpenPlaces {
    std::vector<Imath::V3f> points;  ///< 0.01 voxel over the triangles, in voxels
    std::vector<Imath::V3f> normals; ///< outward, unit
    std::vector<char> flat;          ///< whether that normal is a triangle's own
};

/// One ray back along the normal finds the triangle under each foot: the voxels' surface is rounder than they are, and
/// a start above it would see over what is no higher than that. Of a triangle four voxels wide or more the normal is
/// taken as well: that of the voxels leans over an edge up to two and a half voxels away. The same on any number of
/// threads.
OpenPlaces openPlaces(const SurfaceVoxels& surface, double voxelSize, const Obstacles& obstacles);

} // namespace patina
