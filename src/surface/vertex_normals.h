#pragma once
// Normals for meshes that have no limit surface.

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// Unit normals per vertex: each triangle counts by its angle at the vertex, so that how a flat face is cut makes no
/// difference (Thürmer & Wüthrich 1998). Vertices at exactly the same place share a normal (UV seams of formats that
/// split vertices would crack open otherwise), unless it would oppose their own. A vertex of no triangle with an area
/// gets (0, 0, 1).
std::vector<Imath::V3f> angleWeightedNormals(const std::vector<Imath::V3f>& positions,
                                             const std::vector<Imath::V3i>& triangles);

} // namespace patina
