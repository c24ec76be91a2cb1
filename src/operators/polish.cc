#include "operators/polish.h"

#include "operators/map_factors.h"
#include "operators/nest_layers.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace patina {

namespace {

// Where there is closed air: what of it is still closed when the cut is done. What the cut opens is cut like the rest.
template <typename HeightOf>
std::optional<OpenAir> closedAfterCut(const Workpiece& work, HeightOf heightOf) {
    const LayerVolume& volume = work.volume;
    if (!OpenAir(volume).anyClosed())
        return std::nullopt;
    const auto base = leavesOf(std::as_const(volume.grids().base->tree()));
    const auto top = leavesOf(std::as_const(volume.grids().surface().tree()));
    std::vector<float> cut(work.binding.leafStart(base.size()));
    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        alignas(64) float level[FloatLeaf::SIZE];
        heightOf(n, *base[n], base[n]->buffer().data(), level);
        const float* phi = top[n]->buffer().data();
        std::size_t at = work.binding.leafStart(n);
        forActive(*base[n], [&](openvdb::Index pos) { cut[at++] = std::max(phi[pos], level[pos]); });
    });
    return OpenAir(volume, cut);
}

// phi_k = max(phi_k, phi_0 - h). `heightOf(at, phi)` gives h in the binding's order; a constant one becomes a vector
// loop.
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
    const std::optional<OpenAir> closed = closedAfterCut(work, heightOf);

    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        alignas(64) float level[FloatLeaf::SIZE];
        const float* phi0 = base[n]->buffer().data();
        heightOf(n, *base[n], phi0, level);
        if (closed)
            forActive(*base[n], [&](openvdb::Index pos) {
                if (closed->isSealed(n, pos))
                    level[pos] = -std::numeric_limits<float>::infinity();
            });
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
    report.changedIds = updateMaterialIds(volume, 1e-3, removed || report.grewBand ? nullptr : &changed);
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
