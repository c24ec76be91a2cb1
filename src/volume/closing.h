#pragma once
// Closing of a level set of the nest by a ball: everything that a ball outside cannot reach.

#include "base/progress.h"
#include "volume/layer_volume.h"

#include <vector>

namespace patina {

struct ClosingOptions {
    double radius = 0.0;        ///< of the ball, scene units, > 0
    bool global = false;        ///< only balls that can come from outside
    bool openAirOnly = false;   ///< nothing where only closed air is near the present surface (OpenAir)
    double marginVoxels = 3.0;  ///< the band is grown to hold this much above the closed surface
};

struct Closing {
    /// min(phi_k, closed phi_k), scene units, in the order of the base's leaves and active voxels (as they are when the
    /// call returns). Where the ball touches phi_k at the foot of a voxel (ClosingBalls::touches) these are phi_k's own
    /// bits, elsewhere less by at least t² / 2r, t = contactTolerance. So in a voxel by the surface the level is left
    /// alone exactly where the largest tangent sphere at its foot is no smaller than the ball (accessibleRadii()).
    /// Films that are nowhere thicker than a tenth of a voxel or so, such as false ones along sharp edges, are dropped.
    std::vector<float> level;
    bool changed = false;  ///< whether the closing differs from phi_k anywhere
    bool grewBand = false; ///< the band was grown to hold it: the binding must be bound anew
};

/// Closes interface `k` (0: the floor, what is left of the metal; k: phi_k; -1: phi_0, the metal as it was).
/// \throws RunError where the radius is not positive; Interrupted
Closing closeInterface(LayerVolume& volume, int k, const ClosingOptions& options, Progress& progress);

/// The same with the usual margins, for `fill … above smooth(radius)`: only what air reaches.
/// \param grewBand  set to whether the band grew (bind anew); may be null
inline std::vector<float> closedLevelSet(LayerVolume& volume, int interface, double radius, bool global,
                                         Progress& progress, double marginVoxels = 3.0, bool* grewBand = nullptr) {
    ClosingOptions options;
    options.radius = radius;
    options.global = global;
    options.marginVoxels = marginVoxels;
    options.openAirOnly = true;
    Closing closing = closeInterface(volume, interface, options, progress);
    if (grewBand)
        *grewBand = closing.grewBand;
    return std::move(closing.level);
}

} // namespace patina
