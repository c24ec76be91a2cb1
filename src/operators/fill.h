#pragma once
// fill material height height-map (paper §3.2, Figure 4).

#include "operators/surface_operation.h"

#include <optional>
#include <string>

namespace patina {

/// Pours material up to a height above the bare metal: phi_{n+1} = min(phi_n, phi_0 - h).
///
/// `heightUm` (real µm, >= 0) times the map clamped to 0…1, measured along the bare metal's normal, also where the metal
/// itself was eroded. The map is read at the metal's closest point. The same material on top of itself extends its
/// layer; a fill that reaches nothing adds no layer and changes no bit. The back of a sheet takes nothing.
///
/// \param smoothRadius  scene units, > 0: `above smooth(r)`, heights are measured from the metal closed by a ball of this
///                      radius, so that crevices fill up to h above their brim and open surfaces up to h.
OperationReport fill(Workpiece& work, const std::string& material, double heightUm, const ThicknessMap* map,
                     Progress& progress, std::optional<double> smoothRadius = {});

} // namespace patina
