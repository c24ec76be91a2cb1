#pragma once
// A map asked in other coordinates.

#include "operators/maps/thickness_map.h"

namespace patina {

/// Asks `map` at position * scale + shift: a map that knows the model's coordinates is then asked in a region's, or the
/// other way round. Null stays null.
ThicknessMapPtr makeShiftedMap(ThicknessMapPtr map, double scale, const Imath::V3d& shift);

} // namespace patina
