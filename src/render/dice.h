#pragma once
// The surface in triangles as small as a pixel, where a camera looks.

#include "render/camera.h"
#include "surface/mesh.h"

#include <cstddef>
#include <functional>
#include <limits>

namespace patina {

struct DiceOptions {
    int pictureHeight = 640;                                    ///< pixels
    float pixelsPerEdge = 1.f;                                  ///< no edge in view is longer
    float longestEdge = std::numeric_limits<float>::infinity(); ///< nor longer than this, scene units
    float margin = 0.f; ///< what is displaced this far may come into view, scene units
    /// Dicing ends with the round in which there are more, and leaves coarser triangles than asked for.
    std::size_t mostTriangles = 6000000;
    /// From the surface's coordinates to the camera's; a rigid motion. Empty: the same.
    std::function<Imath::V3f(const Imath::V3f&)> toPicture;
};

/// Splits every edge in view at its middle until it is short enough. Triangles out of view or wholly turned away stay
/// as they are, except where they share a split edge: an edge is split for all its triangles or for none, also across
/// UV seams, so no crack opens between coarse and fine. Normals are interpolated; UVs and faces are left out.
SurfaceMesh diced(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options);

/// Dicing ends after so many rounds: 24 halve the largest edge a float tells from the smallest.
inline constexpr int mostDiceRounds = 24;

/// How many triangles diced() will leave, triangle by triangle: nothing is made. Exact but where a neighbour alone
/// splits an edge, at the border of the view and of what is turned away. \param surface  where the camera is;
/// `options.toPicture` is not applied
std::size_t dicedTriangles(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options);

} // namespace patina
