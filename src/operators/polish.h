#pragma once
// polish height height-map (paper §3.2, Figure 4), and to a fraction of plateau.

#include "operators/surface_operation.h"

namespace patina {

/// Takes away what stands higher than a height above the bare metal: phi_k = max(phi_k, phi_0 - h) for k >= 1.
///
/// `heightUm` (real µm, >= 0) times the map clamped to 0…1, measured along the bare metal's normal. The map is read at
/// the metal's closest point. Layers that are gone everywhere are dropped.
OperationReport polish(Workpiece& work, double heightUm, const ThicknessMap* map, Progress& progress);

/// The same with a height for every active voxel (scene units as drawn, in the binding's order).
OperationReport polishTo(Workpiece& work, const std::vector<float>& heights, Progress& progress);

} // namespace patina
