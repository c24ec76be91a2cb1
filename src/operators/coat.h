#pragma once
// coat material thickness thickness-map (paper §3.2, Figure 4).

#include "operators/surface_operation.h"

namespace patina {

/// Adds material on top: phi_{n+1} = D(phi_n) - t.
///
/// Thickness is solid material along the current surface's normal, `thicknessUm` (real µm, >= 0) times the map clamped
/// to 0…1 (no map: everywhere 1). The same material coated on itself extends the layer. A coat of nothing changes no
/// bit.
///
/// Below a voxel the interface is shifted by g(p) t, where p is the closest point of phi_n and g the slope of phi_n
/// there, so that neither thin films below nor the map's steps suffer; above two voxels the distance to phi_n is used,
/// blended between.
OperationReport coat(Workpiece& work, const std::string& material, double thicknessUm, const ThicknessMap* map,
                     Progress& progress);

} // namespace patina
