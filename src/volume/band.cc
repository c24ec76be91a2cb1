#include "volume/band.h"

#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <openvdb/tools/FastSweeping.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace patina {

bool ensureExteriorBand(LayerVolume& volume, double voxels) {
    NestGrids& grids = volume.grids();
    if (voxels <= grids.exteriorBand)
        return false;
    const int more = static_cast<int>(std::ceil(voxels - grids.exteriorBand));
    const auto grow = [&](openvdb::FloatGrid::Ptr& grid) {
        grid = openvdb::tools::dilateSdf(*grid, more, openvdb::tools::NN_FACE, 1,
                                         openvdb::tools::FastSweepingDomain::SWEEP_GREATER_THAN_ISOVALUE);
    };
    for (auto& interface : grids.interfaces)
        grow(interface);
    grow(grids.base);
    // Sweeping each grid alone may leave topologies that differ by a voxel; all take the union.
    for (auto& interface : grids.interfaces)
        grids.base->tree().topologyUnion(interface->tree());
    for (auto& interface : grids.interfaces)
        interface->tree().topologyUnion(grids.base->tree());
    // Carried outward one by one, interfaces that touch may cross by a rounding error: nest them again.
    const auto nest = grids.nest();
    for (std::size_t k = 1; k < nest.size(); ++k) {
        const auto below = leavesOf(nest[k - 1]->tree());
        const auto here = leavesOf(grids.interfaces[k - 1]->tree());
        tbb::parallel_for(std::size_t(0), here.size(), [&](std::size_t n) {
            for (auto voxel = here[n]->beginValueOn(); voxel; ++voxel)
                voxel.setValue(std::min(*voxel, below[n]->getValue(voxel.pos())));
        });
    }
    grids.material->tree().topologyUnion(grids.base->tree());
    for (auto& field : grids.fields)
        field.second->tree().topologyUnion(grids.base->tree());
    grids.exteriorBand += more;
    updateMaterialIds(volume);
    return true;
}

double stackHeightVoxels(const LayerVolume& volume) {
    const NestGrids& grids = volume.grids();
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    const auto top = leavesOf(std::as_const(grids.surface().tree()));
    const double highest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, base.size()), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double running) {
            for (std::size_t n = range.begin(); n != range.end(); ++n)
                for (auto voxel = base[n]->cbeginValueOn(); voxel; ++voxel)
                    running = std::max(running, double(*voxel) - top[n]->getValue(voxel.pos()));
            return running;
        },
        [](double a, double b) { return std::max(a, b); });
    return highest / volume.scale().voxelSize;
}

} // namespace patina
