#pragma once
// polish area: down to the height at which a fraction of the surface is plateau (material ratio, ISO 25178-2 Smr).

#include "operators/surface_operation.h"

#include <optional>
#include <string>

namespace patina {

/// What `polish area` asks for.
struct AreaPolish {
    double fraction = 1.0;                ///< 0…1 of the bare metal's area
    const ThicknessMap* map = nullptr;    ///< multiplies the depth removed; null: 1 everywhere
    std::optional<double> window;         ///< radius in scene units: a height for every neighbourhood of this radius
    std::string ofMaterial;               ///< until this material (or metal) shows on the fraction; empty: plateau
    std::size_t samples = std::size_t(1) << 18; ///< points at which heights are read, more where windows are small
};

/// Polishes to a height that is found from the heights at evenly spread points of the surface (StackProbe).
///
/// Without a material: Smc(a), the height at or above which the fraction a of the area lies; with a map each place
/// counts by its factor, so that where nothing may be removed there is no plateau. Of a material: down from the highest
/// point, the first height at which the material shows on the fraction a; where it never does, the height at which most
/// of it shows. Never below the bare metal as it was.
///
/// A factor m of the map leaves z - m (z - c) of a height z > c. In the report are the height that was found (the mean
/// of all with a window) and the fraction reached.
OperationReport polishArea(Workpiece& work, const AreaPolish& what, Progress& progress);

} // namespace patina
