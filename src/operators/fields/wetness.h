#pragma once
// Wetness: where water stays (paper §2.2 and §5.2).

#include "base/progress.h"
#include "operators/fields/exposure.h"

namespace patina {

/// Rain that the wind drives: more comes from near the zenith (cos⁶), none from below the horizon; as a dome to gather.
LightDome rainDome();

/// What wetness is made of, per surface voxel, each 0 … 1.
struct WetnessParts {
    std::vector<float> exposure;      ///< gatherDome() of sun and sky: what dries
    std::vector<float> rain;          ///< gatherDome() of rainDome(): what wets
    std::vector<float> accessibility; ///< A / r: creases hold water
};

struct WetnessOptions {
    Imath::V3d up{0.0, 1.0, 0.0}; ///< unit
    double lowest = 0.0;          ///< of the model along up, voxels
    double height = 1.0;          ///< of the model along up, voxels
};

/// With u = n·up, R the rain, E the exposure, a = A / r, h the height above the foot over the model's:
///
///     supply  s = 1 - (1 - d)(1 - R)(1 - q),  d = 0.15 dew,  q = 1 - exp(-Q / 0.06)
///     hold    k = 0.25 + 0.75 smoothstep(0, 0.7, u) where u >= 0;  0.25 (1 + u) under overhangs;  1 in a hollow
///             k' = k + (1 - k) (1 - a)² / 2
///     drying  e = 1 - 0.45 E
///     foot    b = 0.85 exp(-h / 0.05)
///     wetness   = 1 - (1 - s k' e)(1 - b)
///
/// Q is the water that drain() brings from above, as a length of level ground over the model's height. Horizontal and
/// inclined places hold water and vertical ones shed it, daylight dries, and the foot stays damp, as the paper says;
/// its constants are ours, chosen by eye (docs/fields.md).
std::vector<float> wetness(const SurfaceVoxels& surface, const WetnessParts& parts, const WetnessOptions& options);

} // namespace patina
