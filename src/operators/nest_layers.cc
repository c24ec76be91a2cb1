#include "operators/nest_layers.h"

#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

namespace patina {

namespace {

// The layer between two interfaces is somewhere. Far from the crossings differences mean nothing: two interfaces that
// are one there may have been carried outward differently.
bool isAnywhere(const LayerVolume& volume, const std::vector<const FloatLeaf*>& below,
                const std::vector<const FloatLeaf*>& here) {
    const double voxelSize = volume.scale().voxelSize;
    const float nothing = static_cast<float>(std::min(1e-6 * voxelSize, 0.5e-3 * volume.scale().unitsPerUm()));
    const float near = static_cast<float>(1.75 * voxelSize);
    std::atomic<bool> found{false};
    tbb::parallel_for(std::size_t(0), here.size(), [&](std::size_t n) {
        if (found)
            return;
        const float* inner = below[n]->buffer().data();
        const float* outer = here[n]->buffer().data();
        // Most leaves say no: seen in a plain loop over active voxels and others.
        int perhaps = 0;
        for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos)
            perhaps |= (inner[pos] - outer[pos] > nothing) & (outer[pos] < near) & (inner[pos] > -near);
        if (!perhaps)
            return;
        bool any = false;
        forActive(*here[n], [&](openvdb::Index pos) {
            any |= (inner[pos] - outer[pos] > nothing) & (outer[pos] < near) & (inner[pos] > -near);
        });
        if (any)
            found = true;
    });
    return found;
}

} // namespace

bool tidyLayers(LayerVolume& volume) {
    bool removed = false;
    std::vector<std::vector<const FloatLeaf*>> leaves;
    for (const openvdb::FloatGrid* grid : volume.grids().nest())
        leaves.push_back(leavesOf(grid->tree()));
    for (int k = volume.layerCount(); k >= 1; --k)
        if (!isAnywhere(volume, leaves[k - 1], leaves[k])) {
            volume.removeLayer(k);
            removed = true;
        }
    // Of two neighbours of one material the interface between them goes.
    for (int k = volume.layerCount() - 1; k >= 1; --k)
        if (volume.layers()[k - 1] == volume.layers()[k]) {
            volume.removeLayer(k);
            removed = true;
        }
    return removed;
}

} // namespace patina
