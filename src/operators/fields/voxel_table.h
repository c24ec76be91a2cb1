#pragma once
// Surface voxels by place.

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

namespace patina {

/// An open-addressed table from lattice points to their numbers in a list without duplicates, which must outlive it.
class VoxelTable {
  public:
    explicit VoxelTable(const std::vector<Imath::V3i>& voxels) : voxels_(voxels) {
        std::size_t size = 16;
        while (size < 2 * voxels.size())
            size *= 2;
        slots_.assign(size, -1);
        for (std::size_t i = 0; i < voxels.size(); ++i) {
            std::size_t slot = first(voxels[i]);
            while (slots_[slot] >= 0)
                slot = (slot + 1) & (slots_.size() - 1);
            slots_[slot] = static_cast<std::int32_t>(i);
        }
    }
    int find(const Imath::V3i& v) const {
        for (std::size_t slot = first(v); slots_[slot] >= 0; slot = (slot + 1) & (slots_.size() - 1))
            if (voxels_[slots_[slot]] == v)
                return slots_[slot];
        return -1;
    }

  private:
    std::size_t first(const Imath::V3i& v) const {
        const std::uint64_t key = (std::uint64_t(std::uint32_t(v.x)) * 0x9E3779B97F4A7C15ull) ^
                                  (std::uint64_t(std::uint32_t(v.y)) * 0xC2B2AE3D27D4EB4Full) ^
                                  (std::uint64_t(std::uint32_t(v.z)) * 0x165667B19E3779F9ull);
        return (key ^ (key >> 29)) & (slots_.size() - 1);
    }
    const std::vector<Imath::V3i>& voxels_;
    std::vector<std::int32_t> slots_;
};

} // namespace patina
