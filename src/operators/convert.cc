#include "operators/convert.h"

#include "operators/interface_foot.h"
#include "operators/map_factors.h"
#include "operators/nest_layers.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

namespace patina {

namespace {

// The fraction for every active voxel, at its foot on phi_k.
std::vector<float> fractionsOn(int k, const Workpiece& work, double fraction, const ThicknessMap& map,
                               OperationReport& report, Progress& progress) {
    const SurfaceBinding& binding = work.binding;
    const auto base = leavesOf(std::as_const(work.volume.grids().base->tree()));
    std::vector<float> fractions(binding.leafStart(base.size()), 0.f);
    std::vector<ClampedFactors> clamped(base.size());
    const InterfaceFoot feet(work);
    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        std::size_t at = binding.leafStart(n);
        for (auto voxel = base[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            const auto foot = feet.find(k, voxel.getCoord(), at);
            if (foot.under.triangle >= 0)
                fractions[at] =
                    static_cast<float>(fraction * clampedFactor(map, binding.surface(), foot.under, clamped[n]));
        }
    });
    progress.checkpoint();
    for (const ClampedFactors& c : clamped) {
        report.clampedBelow += c.below;
        report.clampedAbove += c.above;
    }
    return fractions;
}

} // namespace

OperationReport convertLayers(Workpiece& work, const std::string& from, const std::string& to, double fraction,
                              const ThicknessMap* map, Progress& progress) {
    OperationReport report;
    LayerVolume& volume = work.volume;
    if (from == to || !(fraction > 0.0))
        return report;
    bool any = false;
    // All fractions first: nothing has changed yet when the work is interrupted.
    std::vector<std::vector<float>> fractions(static_cast<std::size_t>(volume.layerCount()) + 1);
    for (int k = 1; k <= volume.layerCount(); ++k)
        if (volume.layers()[k - 1] == from) {
            any = true;
            if (map)
                fractions[k] = fractionsOn(k, work, fraction, *map, report, progress);
        }
    if (!any)
        return report;
    progress.checkpoint();

    // From the top down, so that the numbers of the layers below stay what they are.
    for (int k = volume.layerCount(); k >= 1; --k) {
        if (volume.layers()[k - 1] != from)
            continue;
        volume.splitLayer(k, to);
        const NestGrids& grids = volume.grids();
        const auto below =
            leavesOf(k == 1 ? std::as_const(grids.floor().tree()) : std::as_const(grids.interfaces[k - 2]->tree()));
        const auto outer = leavesOf(std::as_const(grids.interfaces[k]->tree()));
        const auto split = leavesOf(volume.grids().interfaces[k - 1]->tree());
        tbb::parallel_for(std::size_t(0), split.size(), [&](std::size_t n) {
            const float* inside = below[n]->buffer().data();
            const float* outside = outer[n]->buffer().data();
            float* values = split[n]->buffer().data();
            std::size_t at = work.binding.leafStart(n);
            forActive(*split[n], [&](openvdb::Index pos) {
                const double f = map ? double(fractions[k][at++]) : fraction;
                const double phi = outside[pos];
                // All of it: the very bits of the interface below, so that nothing remains.
                values[pos] = f >= 1.0 ? inside[pos] : static_cast<float>(phi + f * (double(inside[pos]) - phi));
            });
        });
    }
    tidyLayers(volume);
    report.changedIds = updateMaterialIds(volume);
    return report;
}

} // namespace patina
