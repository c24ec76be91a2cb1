#include "volume/band.h"

#include "volume/band_growth.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

namespace {

// Inactive voxels outside a level set that are within `voxels` of what a transform measures the distance to.
std::vector<BlockMask> missingVoxels(const DistanceTransform& transform, double voxels,
                                     const openvdb::CoordBBox& sides) {
    const std::vector<openvdb::Coord> blocks = blocksWithin(transform, voxels);
    const LevelSetBlocks& levelSet = transform.levelSet();
    std::vector<BlockMask> masks(blocks.size());
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t n) {
        BlockMask& mask = masks[n];
        mask.block = blocks[n];
        mask.words.fill(0);
        const FloatLeaf* leaf = levelSet.leafAt(mask.block);
        if (!leaf && levelSet.fillAt(mask.block) < 0.f)
            return;
        std::array<std::uint64_t, 8> wanted;
        wanted.fill(~std::uint64_t(0));
        if (leaf)
            for (int pos = 0; pos < 512; ++pos)
                if (leaf->isValueOn(static_cast<openvdb::Index>(pos)) || !(leaf->buffer().data()[pos] > 0.f))
                    wanted[pos >> 6] &= ~(std::uint64_t(1) << (pos & 63));
        NearestInBlock& near = scratch.local();
        SearchWindow window;
        window.furthest = static_cast<float>(voxels);
        window.mask = wanted.data();
        transform.nearest(mask.block, window, near);
        if (!near.any)
            return;
        for (int pos = 0; pos < 512; ++pos)
            if ((wanted[pos >> 6] >> (pos & 63) & 1) && near.point[pos] >= 0 &&
                (sides.empty() || sides.isInside((mask.block << 3).offsetBy(pos >> 6, (pos >> 3) & 7, pos & 7))) &&
                transform.toFoot(mask.block, pos, near.point[pos]).length() <= voxels)
                mask.words[pos >> 6] |= std::uint64_t(1) << (pos & 63);
    });
    masks.erase(std::remove_if(masks.begin(), masks.end(),
                               [](const BlockMask& mask) {
                                   return std::all_of(mask.words.begin(), mask.words.end(),
                                                      [](std::uint64_t word) { return word == 0; });
                               }),
                masks.end());
    return masks;
}

// The least that the surface's level set is at the band's outer end: how far the surface may move outward.
double leastClearance(const NestGrids& grids) {
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    const auto top = leavesOf(std::as_const(grids.surface().tree()));
    const LeafLattice lattice(base);
    const double least = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, base.size()), std::numeric_limits<double>::max(),
        [&](const tbb::blocked_range<std::size_t>& range, double running) {
            for (std::size_t n = range.begin(); n != range.end(); ++n) {
                const float* phi = top[n]->buffer().data();
                const openvdb::Coord block(base[n]->origin() >> 3);
                const auto open = [&](int x, int y, int z) {
                    if (!grids.sides.empty() && !grids.sides.isInside((block << 3).offsetBy(x, y, z)))
                        return false; // a region's side is no end of the band
                    if ((x | y | z) >= 0 && x < 8 && y < 8 && z < 8)
                        return !base[n]->isValueOn(openvdb::Index(64 * x + 8 * y + z)) &&
                               base[n]->getValue(openvdb::Index(64 * x + 8 * y + z)) > 0.f;
                    const std::int32_t number =
                        lattice.at(block.x() + (x >> 3), block.y() + (y >> 3), block.z() + (z >> 3));
                    const auto pos = static_cast<openvdb::Index>(64 * (x & 7) + 8 * (y & 7) + (z & 7));
                    return number < 0 || (!base[number]->isValueOn(pos) && base[number]->getValue(pos) > 0.f);
                };
                forActive(*base[n], [&](openvdb::Index pos) {
                    if (!(phi[pos] > 0.f) || phi[pos] >= running)
                        return;
                    const int x = int(pos >> 6), y = int((pos >> 3) & 7), z = int(pos & 7);
                    if (open(x - 1, y, z) || open(x + 1, y, z) || open(x, y - 1, z) || open(x, y + 1, z) ||
                        open(x, y, z - 1) || open(x, y, z + 1))
                        running = phi[pos];
                });
            }
            return running;
        },
        [](double a, double b) { return std::min(a, b); });
    return least;
}

} // namespace

bool ensureExteriorBand(LayerVolume& volume, double voxels) {
    NestGrids& grids = volume.grids();
    if (voxels <= grids.exteriorBand)
        return false;
    const double wide = grids.exteriorBand + std::ceil(voxels - grids.exteriorBand);
    const double level = baseLevelForGrowth(volume), voxelSize = volume.scale().voxelSize;
    const DistanceTransform base(*grids.base, voxelSize, level);
    addToBand(volume, missingVoxels(base, wide - level / voxelSize, grids.sides), base, level);
    grids.exteriorBand = wide;
    return true;
}

bool ensureBandAbove(LayerVolume& volume, double voxels) {
    NestGrids& grids = volume.grids();
    const double voxelSize = volume.scale().voxelSize;
    if (voxels + stackHeightVoxels(volume) <= grids.exteriorBand || leastClearance(grids) >= (voxels - 1.0) * voxelSize)
        return false;
    std::vector<BlockMask> missing;
    {
        const DistanceTransform surface(grids.surface(), voxelSize);
        missing = missingVoxels(surface, voxels, grids.sides);
    }
    if (missing.empty())
        return false;
    const double level = baseLevelForGrowth(volume);
    addToBand(volume, missing, DistanceTransform(*grids.base, voxelSize, level), level);
    return true;
}

double stackHeightVoxels(const LayerVolume& volume) {
    const NestGrids& grids = volume.grids();
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    const auto top = leavesOf(std::as_const(grids.surface().tree()));
    const double highest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, base.size()), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double running) {
            for (std::size_t n = range.begin(); n != range.end(); ++n) {
                const float* inner = base[n]->buffer().data();
                const float* outer = top[n]->buffer().data();
                // Most leaves are no higher than what was found: seen in a plain loop over active voxels and others.
                const auto found = static_cast<float>(running);
                int higher = 0;
                for (openvdb::Index pos = 0; pos < FloatLeaf::SIZE; ++pos)
                    higher |= (inner[pos] - outer[pos] >= found) & (inner[pos] > outer[pos]);
                if (higher)
                    forActive(*base[n], [&](openvdb::Index pos) {
                        running = std::max(running, double(inner[pos]) - outer[pos]);
                    });
            }
            return running;
        },
        [](double a, double b) { return std::max(a, b); });
    return highest / volume.scale().voxelSize;
}

} // namespace patina
