#pragma once
// Which vertices lie at exactly the same place.

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// For each position the smallest index of an equal one (-0 equals 0).
std::vector<int> weldedIndices(const std::vector<Imath::V3f>& positions);

} // namespace patina
