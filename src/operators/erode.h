#pragma once
// erode thickness thickness-map (paper §3.2, Figure 4).

#include "operators/surface_operation.h"

#include <optional>
#include <vector>

namespace patina {

/// Hardness of layer k (k from 1): the budget is spent as thickness times hardness. Empty: 1 everywhere.
using LayerHardness = std::vector<double>;

/// Removes material from the top: c = phi_n + t; phi_k = max(phi_k, c), down to the bare metal and not into it.
///
/// `thicknessUm` (real µm, >= 0) times the map, clamped to 0…1, along the current surface's normal. With `hardness`
/// (one value > 0 per layer) a soft layer goes faster than a hard one: in each voxel the budget is spent walking down
/// the differences phi_{k-1} - phi_k; what goes deeper than a voxel is measured by the distance inward. Layers that are gone
/// everywhere are dropped. The walls of closed pores are reached from outside only (sealedRise).
///
/// \param metalHardness  goes on into the metal (`erode … and metal`), which costs thickness times this hardness:
///                       phi_m = max(phi_m, c). `base` stays as it is, the reference of heights.
OperationReport erode(Workpiece& work, double thicknessUm, const ThicknessMap* map, const LayerHardness& hardness,
                      Progress& progress, std::optional<double> metalHardness = {});

} // namespace patina
