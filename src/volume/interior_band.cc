#include "volume/interior_band.h"

#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <openvdb/tools/FastSweeping.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace patina {

bool ensureInteriorBand(LayerVolume& volume, SurfaceBinding& binding, double voxels) {
    NestGrids& grids = volume.grids();
    if (voxels <= grids.interiorBand)
        return false;
    const int more = static_cast<int>(std::ceil(voxels - grids.interiorBand));
    std::vector<openvdb::FloatGrid::Ptr*> all{&grids.base};
    if (grids.metal)
        all.push_back(&grids.metal);
    for (auto& interface : grids.interfaces)
        all.push_back(&interface);
    const auto before = std::make_shared<openvdb::MaskTree>(grids.base->tree(), false, openvdb::TopologyCopy());
    for (openvdb::FloatGrid::Ptr* grid : all)
        *grid = openvdb::tools::dilateSdf(**grid, more, openvdb::tools::NN_FACE, 1,
                                          openvdb::tools::FastSweepingDomain::SWEEP_LESS_THAN_ISOVALUE);
    // Sweeping each grid alone may leave topologies that differ by a voxel; all take the union.
    for (openvdb::FloatGrid::Ptr* grid : all)
        grids.base->tree().topologyUnion((*grid)->tree());
    for (openvdb::FloatGrid::Ptr* grid : all)
        (*grid)->tree().topologyUnion(grids.base->tree());
    grids.material->tree().topologyUnion(grids.base->tree());
    for (auto& field : grids.fields)
        field.second->tree().topologyUnion(grids.base->tree());
    grids.interiorBand += more;
    binding.rebind(volume);

    // The base's new values are distances to the model; the interfaces above keep their order.
    std::vector<std::vector<FloatLeaf*>> leaves;
    for (openvdb::FloatGrid::Ptr* grid : all)
        leaves.push_back(leavesOf((*grid)->tree()));
    const double voxelSize = volume.scale().voxelSize;
    tbb::parallel_for(std::size_t(0), leaves[0].size(), [&](std::size_t n) {
        const openvdb::MaskTree& known = *before;
        std::size_t at = binding.leafStart(n);
        for (auto voxel = leaves[0][n]->beginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            if (known.isValueOn(c))
                continue;
            const SurfacePoint& under = binding.at(at);
            const float swept = *voxel;
            if (under.triangle >= 0) {
                const Imath::V3d x = grids.space.position(c) * voxelSize;
                voxel.setValue(
                    std::copysign(static_cast<float>((positionAt(binding.surface(), under) - x).length()), swept));
            }
            const openvdb::Index pos = voxel.pos();
            for (std::size_t k = 1; k < leaves.size(); ++k) {
                // Each stands as far from the one below as the sweep says.
                const float value = leaves[k][n]->getValue(pos) + (*voxel - swept);
                leaves[k][n]->setValueOnly(pos, value);
            }
        }
    });
    // The metal lies on or below the base; the layers are nested from the floor up.
    const auto nestUp = [&](std::size_t from, std::size_t to, bool above) {
        tbb::parallel_for(std::size_t(0), leaves[0].size(), [&](std::size_t n) {
            const float* reference = leaves[from][n]->buffer().data();
            float* values = leaves[to][n]->buffer().data();
            forActive(*leaves[to][n], [&](openvdb::Index pos) {
                values[pos] = above ? std::min(values[pos], reference[pos]) : std::max(values[pos], reference[pos]);
            });
        });
    };
    if (grids.metal)
        nestUp(0, 1, false);
    for (std::size_t k = grids.metal ? 2 : 1; k < leaves.size(); ++k)
        nestUp(k - 1, k, true);
    updateMaterialIds(volume);
    return true;
}

double metalDepthVoxels(const LayerVolume& volume) {
    const NestGrids& grids = volume.grids();
    if (!grids.metal)
        return 0.0;
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    const auto metal = leavesOf(std::as_const(grids.metal->tree()));
    const double deepest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, base.size()), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double running) {
            float deepestHere = 0.f;
            for (std::size_t n = range.begin(); n != range.end(); ++n) {
                const float* phi0 = base[n]->buffer().data();
                const float* left = metal[n]->buffer().data();
                forActive(*base[n], [&](openvdb::Index pos) {
                    deepestHere = std::max(deepestHere, left[pos] - phi0[pos]);
                });
            }
            return std::max(running, double(deepestHere));
        },
        [](double a, double b) { return std::max(a, b); });
    return deepest / volume.scale().voxelSize;
}

} // namespace patina
