#include "operators/erode.h"

#include "operators/shift_field.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace patina {

namespace {

// phi of the new surface in one voxel: from the top down, each layer costs its thickness times its hardness.
double newSurface(const std::vector<float*>& nest, openvdb::Index voxel, double slope, double thickness,
                  const LayerHardness& hardness) {
    const std::size_t top = nest.size() - 1;
    double surface = nest[top][voxel];
    if (hardness.empty())
        return surface + slope * thickness;
    double budget = slope * thickness;
    for (std::size_t k = top; k >= 1; --k) {
        const double depth = double(nest[k - 1][voxel]) - surface;
        const double cost = depth * hardness[k - 1];
        if (cost >= budget)
            return surface + budget / hardness[k - 1];
        budget -= cost;
        surface = nest[k - 1][voxel];
    }
    return surface;
}

} // namespace

OperationReport erode(Workpiece& work, double thicknessUm, const ThicknessMap* map, const LayerHardness& hardness,
                      Progress& progress) {
    OperationReport report;
    LayerVolume& volume = work.volume;
    if (volume.layerCount() == 0)
        return report;
    const ShiftField field = makeShiftField(work, thicknessUm, map, false, report, progress);

    NestGrids& grids = volume.grids();
    const double voxelSize = volume.scale().voxelSize;
    const std::size_t layers = grids.interfaces.size();
    std::vector<std::vector<FloatLeaf*>> leaves{leavesOf(grids.base->tree())};
    for (auto& interface : grids.interfaces)
        leaves.push_back(leavesOf(interface->tree()));
    std::vector<char> present(leaves[0].size() * layers, 0);

    tbb::parallel_for(std::size_t(0), leaves[0].size(), [&](std::size_t n) {
        std::size_t at = work.binding.leafStart(n);
        std::vector<float*> nest;
        for (std::size_t k = 0; k <= layers; ++k)
            nest.push_back(leaves[k][n]->buffer().data());
        for (auto voxel = leaves[0][n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Index pos = voxel.pos();
            const double t = field.thickness[at];
            if (t > 0.0) {
                double c = newSurface(nest, pos, field.slope[at], t, hardness);
                if (!field.distance.empty() && t > voxelSize && hardness.empty()) {
                    const double blend = std::clamp(t / voxelSize - 1.0, 0.0, 1.0);
                    c += blend * (std::max(double(nest[layers][pos]), field.distance[at] + t) - c);
                }
                const float surface = static_cast<float>(c);
                for (std::size_t k = 1; k <= layers; ++k)
                    nest[k][pos] = std::min(std::max(nest[k][pos], surface), nest[0][pos]);
            }
            for (std::size_t k = 1; k <= layers; ++k)
                if (nest[k][pos] < nest[k - 1][pos])
                    present[n * layers + k - 1] = 1;
        }
    });

    for (std::size_t k = layers; k >= 1; --k) {
        bool anywhere = false;
        for (std::size_t n = 0; n < leaves[0].size() && !anywhere; ++n)
            anywhere = present[n * layers + k - 1] != 0;
        if (!anywhere)
            volume.removeLayer(static_cast<int>(k));
    }
    report.changedIds = updateMaterialIds(volume);
    return report;
}

} // namespace patina
