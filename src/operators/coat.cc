#include "operators/coat.h"

#include "operators/shift_field.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace patina {

OperationReport coat(Workpiece& work, const std::string& material, double thicknessUm, const ThicknessMap* map,
                     Progress& progress) {
    OperationReport report;
    ShiftField field = makeShiftField(work, thicknessUm, map, true, report, progress);
    LayerVolume& volume = work.volume;
    excludeClosedAir(volume, OpenAir(volume), field.thickness);
    const bool extends = volume.layerCount() > 0 && volume.layers().back() == material;
    if (!extends)
        volume.pushLayer(material);

    const double voxelSize = volume.scale().voxelSize;
    const auto leaves = leavesOf(volume.grids().surface().tree());
    std::vector<char> changed(leaves.size(), 0);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = work.binding.leafStart(n);
        float* values = leaves[n]->buffer().data();
        bool coatedAny = false;
        forActive(*leaves[n], [&](openvdb::Index pos) {
            const std::size_t here = at++;
            const double t = field.thickness[here];
            if (t <= 0.0)
                return;
            const double phi = values[pos];
            double coated = phi - field.slope[here] * t;
            if (!field.distance.empty() && t > voxelSize) {
                // Distance takes over between one and two voxels; it may not open the nest.
                const double far = std::min(phi, field.distance[here] - t);
                const double blend = std::clamp(t / voxelSize - 1.0, 0.0, 1.0);
                coated += blend * (far - coated);
            }
            values[pos] = static_cast<float>(std::min(phi, coated));
            coatedAny = true;
        });
        changed[n] = coatedAny;
    });
    report.changedIds = updateMaterialIds(volume, 1e-3, report.grewBand ? nullptr : &changed);
    return report;
}

} // namespace patina
