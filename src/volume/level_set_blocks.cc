#include "volume/level_set_blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace patina {

LevelSetBlocks::LevelSetBlocks(const openvdb::FloatGrid& grid)
    : leaves_(leavesOf(grid.tree())), lattice_(leaves_), background_(grid.background()) {
    // What lies between leaves is a tile: far inside or far outside.
    const openvdb::CoordBBox& box = lattice_.box();
    tbb::parallel_for(box.min().x(), box.max().x() + 1, [&](int i) {
        openvdb::FloatGrid::ConstAccessor accessor = grid.getConstAccessor();
        std::size_t slot = lattice_.slot({i, box.min().y(), box.min().z()});
        for (int j = box.min().y(); j <= box.max().y(); ++j)
            for (int k = box.min().z(); k <= box.max().z(); ++k, ++slot)
                if (lattice_.marked(slot) < 0 && accessor.getValue(openvdb::Coord(i, j, k) << 3) < 0.f)
                    lattice_.mark(slot, -2);
    });
}

void LevelSetBlocks::padded(const openvdb::Coord& block, int low, int high, float* values) const {
    const int n = low + 8 + high;
    // On each axis three runs: from the block before, the block itself, the block behind.
    const int from[4] = {0, low, low + 8, n};
    for (int bi = 0; bi < 3; ++bi)
        for (int bj = 0; bj < 3; ++bj)
            for (int bk = 0; bk < 3; ++bk) {
                if (from[bi] == from[bi + 1] || from[bj] == from[bj + 1] || from[bk] == from[bk + 1])
                    continue;
                const openvdb::Coord at = block.offsetBy(bi - 1, bj - 1, bk - 1);
                const FloatLeaf* leaf = leafAt(at);
                const float fill = leaf ? 0.f : fillAt(at);
                const float* source = leaf ? leaf->buffer().data() : nullptr;
                for (int i = from[bi]; i < from[bi + 1]; ++i)
                    for (int j = from[bj]; j < from[bj + 1]; ++j) {
                        float* row = values + (i * n + j) * n;
                        if (!source) {
                            std::fill(row + from[bk], row + from[bk + 1], fill);
                            continue;
                        }
                        const float* line = source + 64 * ((i - low) & 7) + 8 * ((j - low) & 7);
                        for (int k = from[bk]; k < from[bk + 1]; ++k)
                            row[k] = line[(k - low) & 7];
                    }
            }
}

} // namespace patina
