#pragma once
// New voxels for the band, with true distances in every grid. Includes OpenVDB: for sources only.

#include "volume/distance.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patina {

/// Voxels of one block; word x has bit 8 y + z, as in a leaf.
struct BlockMask {
    openvdb::Coord block; ///< origin / 8
    std::array<std::uint64_t, 8> words;
};

/// Takes the voxels beyond a region's sides out of a block's mask (eight words); nothing where `sides` is empty.
void keepWithin(const openvdb::CoordBBox& sides, const openvdb::Coord& block, std::uint64_t* words);

/// Blocks that are no further from a block that holds seeds than so many voxels.
std::vector<openvdb::Coord> blocksWithin(const DistanceTransform& transform, double voxels);

/// Makes voxels outside all interfaces active in every grid of a volume. Values already there keep their bits; new ones
/// are true distances: of the base to its level set at `baseIso` plus that, of the others to their zero sets, nested
/// from the floor up. IDs of new voxels are those of air, fields 0.
/// \param voxels  inactive voxels outside; blocks in any order, each once
void addToBand(LayerVolume& volume, const std::vector<BlockMask>& voxels, const DistanceTransform& base,
               double baseIso);

/// Where the base's distance is taken from when it is carried on: not its zero set, whose edges are sharper than voxels
/// can show, but the level set two voxels from the band's outer end, which has rounded edges and the same distances.
double baseLevelForGrowth(const LayerVolume& volume);

} // namespace patina
