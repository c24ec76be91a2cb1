#pragma once
// The nearest of a surface's points for every voxel of a block: exact, by lists of candidates that shrink from block to
// voxel. Includes OpenVDB: for sources only.

#include "volume/distance_points.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace patina {

/// Which voxels of a block are asked for. Voxel (x, y, z) has number 64 x + 8 y + z, as in a leaf.
struct SearchWindow {
    float nearest = 0.f;                                    ///< voxels closer than this (in voxels) may be left out
    float furthest = std::numeric_limits<float>::infinity(); ///< … and those further away
    const std::uint64_t* mask = nullptr;  ///< eight words, one for each x; null: all voxels
    const std::uint8_t* relevant = nullptr; ///< one for each point; voxels near none of these may be left out
};

/// The answer for one block, and the workspace. One for each thread, used again for the next block.
struct NearestInBlock {
    static constexpr std::int32_t further = -1, closer = -2; ///< left out: see SearchWindow

    std::array<std::int32_t, 512> point; ///< number of the nearest point, or why there is none
    bool any = false;                    ///< whether some voxel has a point

    struct List {
        std::vector<float> x, y, z; ///< voxels from the block's origin
        std::vector<std::int32_t> id;
        std::vector<float> squared; ///< of the distance last asked for
        std::size_t count = 0;
        void reserve(std::size_t n);
    };
    List lists[3];
};

/// Finds the nearest points. Of b, the nearest to a block's middle, and another point c the difference of the squared
/// distances from x is linear in x, so its least value in the block tells whether c can be the nearest to any of its
/// voxels. Applied to blocks of 8³, 4³ and 2³ voxels in turn, that leaves some tens of distances per voxel.
class NearestPoints {
  public:
    explicit NearestPoints(const PointBlocks& points) : points_(points) {}

    /// Ties go to the point that comes first. Safe from any thread.
    void search(const openvdb::Coord& block, const SearchWindow& window, NearestInBlock& result) const;

  private:
    bool gather(const openvdb::Coord& block, const SearchWindow& window, NearestInBlock& result) const;

    const PointBlocks& points_;
};

} // namespace patina
