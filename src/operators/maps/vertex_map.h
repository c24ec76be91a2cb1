#pragma once
// Values attached to the vertices: the paper's "triangulations as texture maps" (§3.3).

#include "operators/maps/thickness_map.h"
#include "surface/mesh.h"

#include <string>

namespace patina {

/// Interpolates a per-vertex attribute linearly over each triangle.
/// \throws ModelError where the model has no such attribute, naming those it has
ThicknessMapPtr makeVertexMap(const SurfaceMesh& surface, const std::string& attribute);

} // namespace patina
