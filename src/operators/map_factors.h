#pragma once
// A map's factors, clamped to 0…1, with a count of what had to be clamped.

#include "operators/surface_operation.h"

#include <functional>
#include <vector>

namespace patina {

/// Counts of clamped factors, one per leaf so that threads do not share them.
struct ClampedFactors {
    std::size_t below = 0, above = 0;
};

/// The map's value at a surface point, clamped to 0…1; what is not a number counts as 1 too many.
double clampedFactor(const ThicknessMap& map, const SurfaceMesh& surface, const SurfacePoint& under,
                     ClampedFactors& clamped);

/// The map's factor at the base's closest point for every active voxel of the band, in the order of the binding; 0 on
/// the back of a sheet. Without a map 1 everywhere else.
std::vector<float> baseFactors(const Workpiece& work, const ThicknessMap* map, OperationReport& report,
                               Progress& progress);

} // namespace patina
