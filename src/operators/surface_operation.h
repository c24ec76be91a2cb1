#pragma once
// What every operator shares: the volume it works on, the model that maps are asked at, and what it reports.

#include "base/progress.h"
#include "operators/maps/thickness_map.h"
#include "volume/layer_volume.h"
#include "volume/surface_binding.h"

#include <optional>

namespace patina {

/// The nest and the model's surface it grew from.
struct Workpiece {
    LayerVolume& volume;
    SurfaceBinding& binding;
};

/// What an operator has to say afterwards.
struct OperationReport {
    std::size_t clampedBelow = 0; ///< voxels where the map was below 0 and was clamped
    std::size_t clampedAbove = 0; ///< … above 1
    std::size_t changedIds = 0;   ///< voxels whose material ID changed
    bool grewBand = false;
    std::optional<double> heightUm; ///< polish area: the height that was found, where anything had to go
    std::optional<double> fraction; ///< polish area: the fraction of plateau, or of the material, that was reached
};

} // namespace patina
