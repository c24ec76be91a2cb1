#pragma once
// Which voxels of a lattice's columns particles have filled: pores and overhangs, which heights alone cannot hold.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

/// One bit per cell and level; level 1 lies on the surface. Bits lie in planes of 64 levels, so that growing upwards
/// moves nothing.
class LevelOccupancy {
  public:
    explicit LevelOccupancy(std::size_t cells = 0) : cells_(cells) {}

    void add(std::size_t cell, std::int32_t level) {
        const auto plane = static_cast<std::size_t>(level - 1) / 64;
        while (plane >= planes_.size())
            planes_.emplace_back(cells_, 0);
        planes_[plane][cell] |= std::uint64_t(1) << (static_cast<std::size_t>(level - 1) % 64);
    }
    bool holds(std::size_t cell, std::int64_t level) const {
        if (level < 1 || std::size_t(level - 1) / 64 >= planes_.size())
            return false;
        return planes_[std::size_t(level - 1) / 64][cell] >> (std::size_t(level - 1) % 64) & 1u;
    }
    /// Empties a column.
    void clear(std::size_t cell) {
        for (auto& plane : planes_)
            plane[cell] = 0;
    }
    /// No level above this is filled.
    std::int32_t levels() const { return static_cast<std::int32_t>(planes_.size()) * 64; }
    std::size_t cells() const { return cells_; }

  private:
    std::size_t cells_;
    std::vector<std::vector<std::uint64_t>> planes_;
};

} // namespace patina
