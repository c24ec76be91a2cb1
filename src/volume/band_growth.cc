#include "volume/band_growth.h"

#include "volume/nest_grids.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

using BlockValues = std::array<float, 512>;

// Distances (scene units) to a level set, for the voxels of some blocks.
std::vector<BlockValues> distancesAt(const DistanceTransform& transform, const std::vector<BlockMask>& blocks,
                                     double voxelSize, double iso, float nowhere) {
    std::vector<BlockValues> values(blocks.size());
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t n) {
        NearestInBlock& near = scratch.local();
        SearchWindow window;
        window.mask = blocks[n].words.data();
        transform.nearest(blocks[n].block, window, near);
        for (int pos = 0; pos < 512; ++pos)
            values[n][pos] = near.point[pos] < 0
                                 ? nowhere
                                 : static_cast<float>(
                                       iso + transform.toFoot(blocks[n].block, pos, near.point[pos]).length() * voxelSize);
    });
    return values;
}

void write(openvdb::FloatGrid& grid, const std::vector<BlockMask>& blocks, const std::vector<BlockValues>& values) {
    std::vector<FloatLeaf*> leaves;
    for (const BlockMask& block : blocks)
        leaves.push_back(grid.tree().touchLeaf(block.block << 3));
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t n) {
        for (int pos = 0; pos < 512; ++pos)
            if (blocks[n].words[pos >> 6] >> (pos & 63) & 1)
                leaves[n]->setValueOn(static_cast<openvdb::Index>(pos), values[n][pos]);
    });
}

} // namespace

void keepWithin(const openvdb::CoordBBox& sides, const openvdb::Coord& block, std::uint64_t* words) {
    if (sides.empty())
        return;
    const openvdb::Coord origin = block << 3;
    if (sides.isInside(openvdb::CoordBBox(origin, origin.offsetBy(7))))
        return;
    for (int pos = 0; pos < 512; ++pos)
        if (!sides.isInside(origin.offsetBy(pos >> 6, (pos >> 3) & 7, pos & 7)))
            words[pos >> 6] &= ~(std::uint64_t(1) << (pos & 63));
}

double baseLevelForGrowth(const LayerVolume& volume) {
    return std::max(0.0, volume.grids().exteriorBand - 2.0) * volume.scale().voxelSize;
}

std::vector<openvdb::Coord> blocksWithin(const DistanceTransform& transform, double voxels) {
    const PointBlocks& points = transform.seeds().points;
    openvdb::CoordBBox box = points.lattice.box();
    const int reach = static_cast<int>(std::ceil(voxels / 8.0));
    box.expand(reach);
    BlockBox marks(box);
    for (const PointBlocks::Block& block : points.blocks)
        marks.set(block.block, 0);
    widenMarks(marks, reach);
    std::vector<openvdb::Coord> blocks;
    for (std::size_t s = 0; s < marks.numbers().size(); ++s)
        if (marks.numbers()[s] >= 0)
            blocks.push_back(marks.blockOf(s));
    return blocks;
}

void addToBand(LayerVolume& volume, const std::vector<BlockMask>& voxels, const DistanceTransform& base,
               double baseIso) {
    NestGrids& grids = volume.grids();
    const double voxelSize = volume.scale().voxelSize;
    const float nowhere = grids.base->background();
    // All are computed before the first is written, for transforms read the grids.
    std::vector<std::vector<BlockValues>> values{distancesAt(base, voxels, voxelSize, baseIso, nowhere)};
    std::vector<openvdb::FloatGrid*> nest{grids.base.get()};
    if (grids.metal)
        nest.push_back(grids.metal.get());
    for (auto& interface : grids.interfaces)
        nest.push_back(interface.get());
    for (std::size_t k = 1; k < nest.size(); ++k) {
        values.push_back(distancesAt(DistanceTransform(*nest[k], voxelSize), voxels, voxelSize, 0.0, nowhere));
        const bool isMetal = grids.metal && k == 1;
        tbb::parallel_for(std::size_t(0), voxels.size(), [&](std::size_t n) {
            for (int pos = 0; pos < 512; ++pos) {
                const float below = values[k - 1][n][pos];
                float& here = values[k][n][pos];
                // The metal that is left lies below the base, every layer above what it lies on.
                here = isMetal ? std::max(here, below) : std::min(here, below);
            }
        });
    }
    for (std::size_t k = 0; k < nest.size(); ++k)
        write(*nest[k], voxels, values[k]);
    const auto follow = [&](auto& tree) {
        for (const BlockMask& block : voxels) {
            auto* leaf = tree.touchLeaf(block.block << 3);
            for (int pos = 0; pos < 512; ++pos)
                if (block.words[pos >> 6] >> (pos & 63) & 1)
                    leaf->setValueOn(static_cast<openvdb::Index>(pos));
        }
    };
    if (grids.material)
        follow(grids.material->tree());
    for (auto& field : grids.fields)
        follow(field.second->tree());
}

} // namespace patina
