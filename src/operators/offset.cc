#include "operators/offset.h"

#include "base/errors.h"
#include "volume/closing.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace patina {

OperationReport offset(Workpiece& work, const std::string& material, double radius, bool global, Progress& progress) {
    if (!(radius > 0.0))
        throw RunError("offset", "the ball's radius must be positive", "give a length of the model, such as 0.2mm");
    OperationReport report;
    LayerVolume& volume = work.volume;
    ClosingOptions options;
    options.radius = radius;
    options.global = global;
    options.openAirOnly = true;
    const Closing closing = closeInterface(volume, volume.layerCount(), options, progress);
    if (!closing.changed)
        return report;
    if (closing.grewBand) {
        work.binding.rebind(volume);
        report.grewBand = true;
    }
    const bool extends = volume.layerCount() > 0 && volume.layers().back() == material;
    if (!extends)
        volume.pushLayer(material);

    const bool back = work.binding.hasBack();
    const OpenAir air(volume);
    const auto leaves = leavesOf(volume.grids().surface().tree());
    std::vector<char> changed(leaves.size(), 0);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = work.binding.leafStart(n);
        float* phi = leaves[n]->buffer().data();
        bool any = false;
        forActive(*leaves[n], [&](openvdb::Index pos) {
            const std::size_t here = at++;
            if (!(closing.level[here] < phi[pos]) || (back && work.binding.at(here).triangle < 0) ||
                air.isSealed(n, pos))
                return;
            phi[pos] = closing.level[here];
            any = true;
        });
        changed[n] = any;
    });
    if (!extends && std::find(changed.begin(), changed.end(), 1) == changed.end())
        volume.removeLayer(volume.layerCount());
    // Where the palette is as it was, only the changed leaves are looked at.
    report.changedIds = updateMaterialIds(volume, 1e-3, report.grewBand ? nullptr : &changed);
    return report;
}

} // namespace patina
