#pragma once
// Points spread evenly over the model's surface.

#include "surface/mesh.h"

#include <vector>

namespace patina {

/// `count` points of equal shares of the area: triangle after triangle by their areas, inside a triangle by a
/// two-dimensional low-discrepancy sequence (Roberts' R2). The same for the same surface.
std::vector<SurfacePoint> evenSamples(const SurfaceMesh& surface, std::size_t count);

} // namespace patina
