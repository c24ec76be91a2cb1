#include "operators/polish.h"

#include "operators/map_factors.h"
#include "operators/nest_layers.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace patina {

namespace {

// phi_k = max(phi_k, phi_0 - h). `heightOf(at, phi)` gives h in the binding's order; a constant one becomes a vector loop.
template <typename HeightOf>
OperationReport cut(Workpiece& work, HeightOf heightOf) {
    OperationReport report;
    LayerVolume& volume = work.volume;
    NestGrids& grids = volume.grids();
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    std::vector<std::vector<FloatLeaf*>> interfaces;
    for (auto& interface : grids.interfaces)
        interfaces.push_back(leavesOf(interface->tree()));
    std::vector<char> changed(base.size(), 0);

    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        alignas(64) float level[FloatLeaf::SIZE];
        const float* phi0 = base[n]->buffer().data();
        heightOf(n, *base[n], phi0, level);
        for (std::size_t k = interfaces.size(); k-- > 0;) {
            float* phi = interfaces[k][n]->buffer().data();
            int cuts = 0;
            forActive(*base[n], [&](openvdb::Index pos) {
                cuts |= level[pos] > phi[pos];
                phi[pos] = std::max(phi[pos], level[pos]);
            });
            if (!cuts)
                break; // what lies below is deeper still
            changed[n] = 1;
        }
    });
    const bool removed = tidyLayers(volume);
    report.changedIds = updateMaterialIds(volume, 1e-3, removed ? nullptr : &changed);
    return report;
}

} // namespace

OperationReport polish(Workpiece& work, double heightUm, const ThicknessMap* map, Progress& progress) {
    progress.checkpoint();
    const double height = heightUm * work.volume.scale().unitsPerUm();
    if (!map) {
        const float h = static_cast<float>(height);
        return cut(work, [h](std::size_t, const FloatLeaf& leaf, const float* phi0, float* level) {
            forActive(leaf, [&](openvdb::Index pos) { level[pos] = phi0[pos] - h; });
        });
    }
    OperationReport mapped;
    std::vector<float> heights = baseFactors(work, map, mapped, progress);
    for (float& h : heights)
        h = static_cast<float>(h * height);
    OperationReport report = polishTo(work, heights, progress);
    report.clampedBelow = mapped.clampedBelow;
    report.clampedAbove = mapped.clampedAbove;
    return report;
}

OperationReport polishTo(Workpiece& work, const std::vector<float>& heights, Progress& progress) {
    progress.checkpoint();
    return cut(work, [&](std::size_t n, const FloatLeaf& leaf, const float* phi0, float* level) {
        std::size_t at = work.binding.leafStart(n);
        forActive(leaf, [&](openvdb::Index pos) { level[pos] = phi0[pos] - heights[at++]; });
    });
}

} // namespace patina
