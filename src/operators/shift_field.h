#pragma once
// Per voxel of the band: how far an operator moves the surface there. Shared by coat and erode.

#include "operators/surface_operation.h"

#include <vector>

namespace patina {

/// In the order of the base's leaves and active voxels (see SurfaceBinding).
struct ShiftField {
    std::vector<float> thickness; ///< scene units as drawn, along the surface's normal, at the voxel's closest point p
    std::vector<float> slope;     ///< |grad phi_n| at p (scene units per scene unit)
    std::vector<float>
        distance; ///< signed distance to phi_n, scene units; empty where every move is below a voxel
};

/// How far the surface may move for a thickness of 1: other than that where layers differ in hardness.
struct ShiftReach {
    double least = 1.0, most = 1.0;
};

/// \param outward  whether material is added (thicknesses beyond the band make the band grow first)
ShiftField makeShiftField(Workpiece& work, double thicknessUm, const ThicknessMap* map, bool outward,
                          OperationReport& report, Progress& progress, ShiftReach reach = {});

} // namespace patina
