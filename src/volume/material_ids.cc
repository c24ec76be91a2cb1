#include "volume/material_ids.h"

#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace patina {

std::size_t updateMaterialIds(LayerVolume& volume, double presenceUm) {
    NestGrids& grids = volume.grids();
    const NestSampler sampler(grids);
    const int layers = volume.layerCount();
    const double voxelSize = volume.scale().voxelSize;
    const double presence = presenceUm * volume.scale().unitsPerUm();

    std::vector<std::int32_t> ids{1};
    for (const std::string& material : volume.layers())
        ids.push_back(volume.materialId(material));

    const auto baseLeaves = leavesOf(std::as_const(grids.base->tree()));
    const auto idLeaves = leavesOf(grids.material->tree());
    std::vector<std::size_t> changed(baseLeaves.size(), 0);
    tbb::parallel_for(std::size_t(0), baseLeaves.size(), [&](std::size_t n) {
        const FloatLeaf& base = *baseLeaves[n];
        IdLeaf& leaf = *idLeaves[n];
        for (auto voxel = base.cbeginValueOn(); voxel; ++voxel) {
            const openvdb::Coord coord = voxel.getCoord();
            const double top = sampler.voxel(layers, coord);
            std::int32_t id = 0;
            // Half the length of the normal's line within the voxel is at most half the diagonal.
            if (top > 0.9 * voxelSize) {
                id = 0;
            } else {
                Imath::V3d gradient = sampler.centralGradient(layers, coord) / voxelSize;
                const double g = std::max(gradient.length(), 1e-6);
                gradient /= g;
                const double steepest =
                    std::max({std::abs(gradient.x), std::abs(gradient.y), std::abs(gradient.z), 0.5});
                const double half = 0.5 * voxelSize / steepest;
                // Layer k lies on the line between -phi_{k-1}/g and -phi_k/g.
                for (int k = layers; k >= 0 && id == 0; --k) {
                    const double outer = std::min(half, -sampler.voxel(k, coord) / g);
                    const double inner =
                        k == 0 ? -half : std::max(-half, -static_cast<double>(sampler.voxel(k - 1, coord)) / g);
                    if (outer - inner > (k == 0 ? 0.0 : presence))
                        id = ids[k];
                }
            }
            if (leaf.getValue(voxel.pos()) != id) {
                leaf.setValueOnly(voxel.pos(), id);
                ++changed[n];
            }
        }
    });
    return std::accumulate(changed.begin(), changed.end(), std::size_t(0));
}

} // namespace patina
