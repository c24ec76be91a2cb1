#include "operators/coat.h"

#include "operators/shift_field.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace patina {

OperationReport coat(Workpiece& work, const std::string& material, double thicknessUm, const ThicknessMap* map,
                     Progress& progress) {
    OperationReport report;
    const ShiftField field = makeShiftField(work, thicknessUm, map, true, report, progress);
    LayerVolume& volume = work.volume;
    const bool extends = volume.layerCount() > 0 && volume.layers().back() == material;
    if (!extends)
        volume.pushLayer(material);

    const double voxelSize = volume.scale().voxelSize;
    const auto leaves = leavesOf(volume.grids().surface().tree());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = work.binding.leafStart(n);
        float* values = leaves[n]->buffer().data();
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            const double t = field.thickness[at];
            if (t <= 0.0)
                continue;
            const double phi = values[voxel.pos()];
            double coated = phi - field.slope[at] * t;
            if (!field.distance.empty() && t > voxelSize) {
                // Distance takes over between one and two voxels; it may not open the nest.
                const double far = std::min(phi, field.distance[at] - t);
                const double blend = std::clamp(t / voxelSize - 1.0, 0.0, 1.0);
                coated += blend * (far - coated);
            }
            values[voxel.pos()] = static_cast<float>(std::min(phi, coated));
        }
    });
    report.changedIds = updateMaterialIds(volume);
    return report;
}

} // namespace patina
