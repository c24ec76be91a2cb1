#include "operators/fill.h"

#include "operators/map_factors.h"
#include "volume/band.h"
#include "volume/closing.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace patina {

OperationReport fill(Workpiece& work, const std::string& material, double heightUm, const ThicknessMap* map,
                     Progress& progress, std::optional<double> smoothRadius) {
    OperationReport report;
    LayerVolume& volume = work.volume;
    NestGrids& grids = volume.grids();
    const double height = heightUm * volume.scale().unitsPerUm();
    const double margin = height / volume.scale().voxelSize + 3.0;
    report.grewBand = ensureExteriorBand(volume, margin);
    std::vector<float> smooth;
    if (smoothRadius) {
        bool grew = false;
        smooth = closedLevelSet(volume, -1, *smoothRadius, false, progress, margin, &grew);
        report.grewBand |= grew;
    }
    if (report.grewBand)
        work.binding.rebind(volume);
    progress.checkpoint();
    const OpenAir air(volume);
    const bool everywhere = !map && !smoothRadius && !work.binding.hasBack() && !air.anyClosed();
    std::vector<float> heights;
    if (!everywhere) {
        heights = baseFactors(work, map, report, progress);
        for (float& h : heights)
            h = static_cast<float>(h * height);
    }
    const bool extends = volume.layerCount() > 0 && volume.layers().back() == material;
    if (!extends)
        volume.pushLayer(material);

    const auto base = leavesOf(std::as_const(grids.base->tree()));
    const auto top = leavesOf(grids.surface().tree());
    const float even = static_cast<float>(height);
    std::vector<char> changed(base.size(), 0);
    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        const float* phi0 = base[n]->buffer().data();
        float* phi = top[n]->buffer().data();
        int filled = 0;
        if (everywhere) {
            forActive(*base[n], [&](openvdb::Index pos) {
                const float level = phi0[pos] - even;
                filled |= level < phi[pos];
                phi[pos] = std::min(phi[pos], level);
            });
        } else {
            std::size_t at = work.binding.leafStart(n);
            forActive(*base[n], [&](openvdb::Index pos) {
                const std::size_t here = at++;
                if (work.binding.at(here).triangle < 0 || air.isSealed(n, pos))
                    return; // the back of a sheet, or where no air comes
                const float level = (smoothRadius ? smooth[here] : phi0[pos]) - heights[here];
                filled |= level < phi[pos];
                phi[pos] = std::min(phi[pos], level);
            });
        }
        changed[n] = filled != 0;
    });
    if (!extends && std::find(changed.begin(), changed.end(), 1) == changed.end())
        volume.removeLayer(volume.layerCount());
    report.changedIds = updateMaterialIds(volume, 1e-3, report.grewBand ? nullptr : &changed);
    return report;
}

} // namespace patina
