#pragma once
// What closes a hole: triangles between the vertices of its rim.

#include <Imath/ImathVec.h>

#include <functional>
#include <vector>

namespace patina {

/// Cuts a closed polygon in space, not necessarily planar, into count - 2 triangles of local corner numbers, in its
/// winding, with the least total area (Barequet & Sharir 1995). Rims of more than 200 corners lose their sharpest
/// corners first.
/// \param allowed  whether two corners may be joined (false where the mesh has that edge already); may be empty
std::vector<Imath::V3i> capHole(const std::vector<Imath::V3f>& rim,
                                const std::function<bool(int, int)>& allowed = {});

} // namespace patina
