#pragma once
// Maps that only look at where a point is and which way it faces.

#include "operators/maps/thickness_map.h"

#include <Imath/ImathBox.h>

namespace patina {

/// Inclination: 0 where the surface is vertical or overhangs, 1 where it is horizontal and looks up (the cosine between
/// normal and up, clamped).
ThicknessMapPtr makeSlopeMap(const Imath::V3d& up);

/// Height along up: 0 at the model's lowest point, 1 at its highest.
ThicknessMapPtr makeElevationMap(const Imath::V3d& up, const Imath::Box3d& bounds);

/// 1 where the surface looks in the direction, 0 where it looks sideways or away (the clamped cosine).
ThicknessMapPtr makeFacingMap(const Imath::V3d& direction);

} // namespace patina
