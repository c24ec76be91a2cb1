#pragma once
// What the layers of a volume amount to, measured over the model's surface.

#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <cstddef>
#include <vector>

namespace patina {

/// Of one layer, weighted by the area of the base surface. Thicknesses in real µm.
struct LayerStatistics {
    std::string material;
    double meanUm = 0.0;
    double maxUm = 0.0;
    double coverage = 0.0;    ///< fraction of the area where the layer is thicker than a nanometre
    double roughnessUm = 0.0; ///< Rq: rms of the thickness about its mean
    double volumeM3 = 0.0;    ///< real: mean thickness times area
};

struct StackStatistics {
    std::vector<LayerStatistics> layers; ///< bottom to top
    LayerStatistics total;               ///< of the sum of the layers
    LayerStatistics metalLoss;           ///< of the metal that is gone below the base; zeros where it never was eroded
    double areaM2 = 0.0;
    double voxelizationErrorVoxels = 0.0; ///< rms distance between the model and phi_0 along the normal
    double unreadable = 0.0;              ///< fraction of the area where no base was found along the normal
};

/// Reads the stack at the centre of every triangle, or of every second, third, … of them.
StackStatistics measureStack(const LayerVolume& volume, const SurfaceMesh& surface, std::size_t every = 1);

} // namespace patina
