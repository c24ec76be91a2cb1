#pragma once
// convert A to B fraction map: one material turns into another where it lies (posnjakite to brochantite).

#include "operators/surface_operation.h"

#include <string>

namespace patina {

/// Turns the fraction of every layer of `from` that faces the air into `to`, under other layers too: the layer is split
/// by a new interface phi = phi_k + f (phi_{k-1} - phi_k), below which `from` remains.
///
/// `fraction` (0…1) times the map clamped to 0…1, the map read at the closest point of the layer's interface. Solid per
/// area is kept: what turns into a denser or lighter mineral keeps its thickness. Neighbouring layers that have become one
/// material are merged, a layer that is gone is dropped. The surface does not change.
OperationReport convertLayers(Workpiece& work, const std::string& from, const std::string& to, double fraction,
                              const ThicknessMap* map, Progress& progress);

} // namespace patina
