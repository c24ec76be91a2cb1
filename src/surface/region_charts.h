#pragma once
// UVs for a piece of surface or a scan: flat projections that fill the tile.

#include "surface/mesh.h"

namespace patina {

/// Replaces the UVs. A piece that faces one way is projected along its mean normal; otherwise connected triangles that
/// face the same axis are projected along it (lengths shrink by at most 1.8), small patches join a neighbour, and what
/// would lie on itself is taken apart. Charts
/// are drawn to one scale, with a gap of `gapTexels` of a map of `resolution` texels around each, and packed in rows.
/// `up` runs up the tile where it can.
void makeProjectedCharts(SurfaceMesh& surface, const Imath::V3d& up, int resolution, int gapTexels = 8);

/// The same for a model before it is subdivided. \pre all faces are triangles
void makeProjectedCharts(Mesh& mesh, const Imath::V3d& up, int resolution, int gapTexels = 8);

} // namespace patina
