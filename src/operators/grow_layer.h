#pragma once
// grow material thickness map: corrosion goes on under the patina (paper §3.3, Figure 10).

#include "operators/surface_operation.h"

#include <string>

namespace patina {

/// Thickens a layer where it lies: its interface and all above it move out together, phi_j -= g t, j >= k.
///
/// `thicknessUm` (real µm, >= 0) times the map clamped to 0…1, along the normal of the layer's own interface; g is the
/// slope of phi_k and both are read at p, the closest point of that interface. What is above moves as it is, so that
/// films buried there keep their thickness. Where the material lies in several layers, the lowest that is there (thicker
/// than a nanometre) grows; where it does not lie, nothing happens.
///
/// `everywhere`: where it does not lie, it begins anew in its place in the stack, under what lies above its lowest
/// layer; where the volume has no layer of it at all, it is laid on top as coat() does. So a mineral that the weather
/// has worn off here and there comes again.
OperationReport growLayer(Workpiece& work, const std::string& material, double thicknessUm, const ThicknessMap* map,
                          Progress& progress, bool everywhere = false);

} // namespace patina
