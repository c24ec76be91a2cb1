#pragma once
// offset material radius tangent-sphere thickness (paper §3.2; Miller 1994, his first version).

#include "operators/surface_operation.h"

namespace patina {

/// A coat of `thicknessUm` (real µm, >= 0) of material where the largest sphere that touches the surface from outside
/// is smaller than `radiusSceneUnits` (> 0); nothing elsewhere. The edge is as soft as one voxel of the sphere's
/// radius. `global` counts only spheres that can come from outside (fields/accessibility.h).
/// \throws RunError where the radius is not positive; Interrupted
OperationReport offsetTangentSphere(Workpiece& work, const std::string& material, double radiusSceneUnits,
                                    double thicknessUm, bool global, Progress& progress);

} // namespace patina
