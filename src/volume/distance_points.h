#pragma once
// Points of a surface in blocks of 8³ voxels, ready to be searched. Includes OpenVDB: for sources only.

#include "volume/grid_instances.h"

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace patina {

/// A dense box of 8³ blocks with a number for each; -1 where there is none and outside the box.
class BlockBox {
  public:
    BlockBox() = default;
    /// \param box  in blocks (voxels / 8); may be empty
    explicit BlockBox(const openvdb::CoordBBox& box) : box_(box) {
        if (box_.empty())
            box_ = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(0));
        size_ = box_.dim();
        numbers_.assign(std::size_t(size_.x()) * size_.y() * size_.z(), -1);
    }

    const openvdb::CoordBBox& box() const { return box_; }
    bool holds(const openvdb::Coord& block) const { return box_.isInside(block); }
    std::int32_t at(const openvdb::Coord& block) const { return holds(block) ? numbers_[slot(block)] : -1; }
    void set(const openvdb::Coord& block, std::int32_t number) { numbers_[slot(block)] = number; }

    std::size_t slot(const openvdb::Coord& block) const {
        const openvdb::Coord c = block - box_.min();
        return (std::size_t(c.x()) * size_.y() + c.y()) * size_.z() + c.z();
    }
    openvdb::Coord blockOf(std::size_t slot) const {
        const auto z = static_cast<std::size_t>(size_.z()), y = static_cast<std::size_t>(size_.y());
        return box_.min() + openvdb::Coord(int(slot / (y * z)), int(slot / z % y), int(slot % z));
    }
    std::vector<std::int32_t>& numbers() { return numbers_; }
    const std::vector<std::int32_t>& numbers() const { return numbers_; }

  private:
    openvdb::CoordBBox box_;
    openvdb::Coord size_;
    std::vector<std::int32_t> numbers_;
};

/// Sets to 0 every block within `reach` blocks (along each axis) of one that has a number >= 0; the others become -1.
void widenMarks(BlockBox& marks, int reach);

/// Points sorted by the block they lie in. Coordinates are in voxels from the block's origin, so that single precision
/// is as good at the far end of a large model.
struct PointBlocks {
    struct Block {
        openvdb::Coord block;     ///< origin / 8
        std::uint32_t begin, end; ///< its points
    };
    std::vector<Block> blocks; ///< those that hold points
    BlockBox lattice;          ///< block to index into `blocks`
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> blockOf; ///< of each point, index into `blocks`; empty where they are too many for it

    std::size_t size() const { return x.size(); }
    void resize(std::size_t count) {
        x.resize(count);
        y.resize(count);
        z.resize(count);
        blockOf.resize(count);
    }

    const Block& blockOfPoint(std::int32_t point) const {
        if (!blockOf.empty())
            return blocks[blockOf[point]];
        const auto after = std::upper_bound(blocks.begin(), blocks.end(), static_cast<std::uint32_t>(point),
                                            [](std::uint32_t p, const Block& b) { return p < b.begin; });
        return *(after - 1);
    }

    /// A point in voxels from another block's origin.
    Imath::V3f from(const openvdb::Coord& block, std::int32_t point) const {
        const openvdb::Coord apart = blockOfPoint(point).block - block;
        return {x[point] + 8.f * float(apart.x()), y[point] + 8.f * float(apart.y()),
                z[point] + 8.f * float(apart.z())};
    }
};

} // namespace patina
