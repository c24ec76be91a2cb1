#pragma once
// Sharp creases between the patches of a surface. Includes OpenVDB: for sources only.

#include "volume/distance_seeds.h"

namespace patina {

/// Where two or three faces meet sharply no cell knows the line: its seed lies on a chord, and differences across the
/// crease bend the patches beside it. Moves such seeds onto the crease, as pieces of a line (or a point, in a
/// corner); ends faces at their creases; lays patches beside a crease into the plane of the face that they lie on.
void sharpenCreases(SurfaceSeeds& seeds);

} // namespace patina
