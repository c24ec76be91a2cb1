#include "script/budget.h"

#include "script/interpreter.h"

#include <algorithm>
#include <cmath>

namespace patina {

Budget estimateBudget(const Program& program, const SurfaceMesh& surface, const VolumeScale& scale, int mapResolution) {
    Budget budget;
    // Not every coat makes an interface (the same material on itself does not); the estimate takes the most there can
    // be.
    double layers = 0.0;
    for (const Statement& statement : program.statements)
        if (std::holds_alternative<Coat>(statement.action))
            layers += 1.0;
    constexpr double interiorBand = 4.0;
    const double exteriorBand = std::max(4.0, std::ceil(thickestStackVoxels(program, scale)) + 3.0);
    // A sheet's back and front both carry a band.
    const double sides = surface.closed ? 1.0 : 2.0;
    const double area = sides * surface.area() / (scale.voxelSize * scale.voxelSize);
    const double width = interiorBand + exteriorBand;
    budget.activeVoxels = area * width;
    budget.allocatedVoxels = area * (width + 12.0);
    constexpr double bytesPerValue = 4.0 * 1.03; // a leaf's masks and node are 3 % of its values
    budget.volumeBytes = budget.allocatedVoxels * bytesPerValue * (layers + 2.0);
    const double texels = static_cast<double>(mapResolution) * mapResolution;
    const double bytesPerTexel = 4.0 + 6.0 * (layers + 1.0) + 6.0 * (layers + 1.0) + 16.0 + 12.0;
    budget.mapBytes = texels * bytesPerTexel;
    // While it runs: a closest point per voxel, shift fields of three floats, triangles with their trees, the program.
    constexpr double programBytes = 150e6, bytesPerTriangle = 400.0;
    const double working = budget.activeVoxels * (12.0 + 8.0);
    const double model = static_cast<double>(surface.triangles.size()) * bytesPerTriangle;
    budget.peakBytes = programBytes + model + budget.volumeBytes + std::max(working, budget.mapBytes);
    budget.diskBytes = budget.allocatedVoxels * 4.0 * (layers + 3.0) + budget.mapBytes;
    return budget;
}

} // namespace patina
