#pragma once
// Cutting a surface at the sides of a box, and its triangles into small ones.

#include "surface/mesh.h"

#include <Imath/ImathBox.h>

namespace patina {

/// What lies in the box (the surface's own coordinates). Normals, UVs and attributes are interpolated along cut edges;
/// triangles that shared an edge share the new vertices on it. `closed` is kept as it is: the cut is no rim.
SurfaceMesh clippedTo(const SurfaceMesh& surface, const Imath::Box3d& box);

/// Halves edges, wherever they are longer than `longestEdge`, until none is; both triangles of an edge agree on its
/// middle. Normals, UVs and attributes are interpolated.
SurfaceMesh diced(const SurfaceMesh& surface, double longestEdge);

} // namespace patina
