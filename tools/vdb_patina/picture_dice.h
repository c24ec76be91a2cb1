#pragma once
// How a picture's surface is diced, and how many triangles that will make.

#include "options.h"
#include "view_input.h"

#include "render/dice.h"

namespace patina::tool {

/// Dicing of a model under layers for a picture. \param voxel  the volume's voxel size: what the stack is read at
/// vertices for must not be wider than one and a half of them
DiceOptions dicingOf(const View& view, const Options& options, double voxel);

/// How many triangles diced() will leave: the same edges are halved, triangle by triangle, and nothing is made. Exact but
/// where a neighbour alone splits an edge, at the border of the view and of what is turned away.
/// \param surface  where the camera is; `options.toPicture` is not applied
std::size_t dicedTriangles(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options);

} // namespace patina::tool
