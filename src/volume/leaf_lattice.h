#pragma once
// Leaf numbers by place. Includes OpenVDB: for volume/, operators/ and export/ sources.

#include "volume/nest_grids.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace patina {

/// The leaves of one topology in a box of 8³ blocks: which number (in leavesOf()'s order) the leaf at a block has.
class LeafLattice {
  public:
    explicit LeafLattice(const std::vector<const FloatLeaf*>& leaves) {
        for (const FloatLeaf* leaf : leaves)
            box_.expand(openvdb::Coord(leaf->origin() >> 3));
        if (leaves.empty())
            box_ = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(0));
        size_ = box_.dim();
        number_.assign(std::size_t(size_.x()) * size_.y() * size_.z(), -1);
        for (std::size_t n = 0; n < leaves.size(); ++n)
            number_[slot(leaves[n]->origin() >> 3)] = static_cast<std::int32_t>(n);
    }

    const openvdb::CoordBBox& box() const { return box_; } ///< in blocks (voxels / 8)
    bool holds(int i, int j, int k) const { return box_.isInside(openvdb::Coord(i, j, k)); }
    std::size_t slot(const openvdb::Coord& block) const {
        const openvdb::Coord c = block - box_.min();
        return (std::size_t(c.x()) * size_.y() + c.y()) * size_.z() + c.z();
    }

    /// The number of the leaf at a block; a negative one where there is none (-1 unless marked otherwise).
    std::int32_t at(int i, int j, int k) const {
        i -= box_.min().x();
        j -= box_.min().y();
        k -= box_.min().z();
        if (unsigned(i) >= unsigned(size_.x()) || unsigned(j) >= unsigned(size_.y()) ||
            unsigned(k) >= unsigned(size_.z()))
            return -1;
        return number_[(std::size_t(i) * size_.y() + j) * size_.z() + k];
    }
    void mark(std::size_t slot, std::int32_t value) { number_[slot] = value; }
    std::int32_t marked(std::size_t slot) const { return number_[slot]; }

  private:
    openvdb::CoordBBox box_;
    openvdb::Coord size_;
    std::vector<std::int32_t> number_;
};

/// One bit for each voxel of a leaf; word x has bit 8 y + z.
using VoxelMask = std::array<std::uint64_t, 8>;

/// The voxels (0 … 511) for which `test(position)` holds. Tests of plain arrays become vector instructions.
template <typename Test>
inline VoxelMask voxelsWhere(Test test) {
    VoxelMask mask;
    for (unsigned w = 0; w < 8; ++w) {
        unsigned char holds[64];
        for (unsigned i = 0; i < 64; ++i)
            holds[i] = test(64 * w + i);
        std::uint64_t word = 0;
        for (unsigned row = 0; row < 8; ++row) {
            std::uint64_t bytes;
            std::memcpy(&bytes, holds + 8 * row, 8);
            // Eight bytes of 0 or 1 become eight bits.
            word |= (bytes * 0x0102040810204080ull >> 56) << (8 * row);
        }
        mask[w] = word;
    }
    return mask;
}

/// The voxels whose value is above a level: as voxelsWhere, several times as fast where four values are compared at
/// once.
inline VoxelMask voxelsAbove(const float* values, float level) {
#if defined(__SSE2__)
    VoxelMask mask;
    const __m128 bound = _mm_set1_ps(level);
    for (unsigned w = 0; w < 8; ++w) {
        std::uint64_t word = 0;
        for (unsigned part = 0; part < 4; ++part) {
            const float* from = values + 64 * w + 16 * part;
            const auto above = [&](unsigned i) {
                return _mm_castps_si128(_mm_cmpgt_ps(_mm_loadu_ps(from + i), bound));
            };
            const __m128i bytes =
                _mm_packs_epi16(_mm_packs_epi32(above(0), above(4)), _mm_packs_epi32(above(8), above(12)));
            word |= std::uint64_t(unsigned(_mm_movemask_epi8(bytes))) << (16 * part);
        }
        mask[w] = word;
    }
    return mask;
#else
    return voxelsWhere([=](unsigned i) { return values[i] > level; });
#endif
}

/// The voxels whose value is another one, likewise.
inline VoxelMask voxelsOtherThan(const std::int32_t* values, std::int32_t one) {
#if defined(__SSE2__)
    VoxelMask mask;
    const __m128i same = _mm_set1_epi32(one);
    for (unsigned w = 0; w < 8; ++w) {
        std::uint64_t word = 0;
        for (unsigned part = 0; part < 4; ++part) {
            const std::int32_t* from = values + 64 * w + 16 * part;
            const auto equal = [&](unsigned i) {
                return _mm_cmpeq_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i)), same);
            };
            const __m128i bytes =
                _mm_packs_epi16(_mm_packs_epi32(equal(0), equal(4)), _mm_packs_epi32(equal(8), equal(12)));
            word |= std::uint64_t(unsigned(_mm_movemask_epi8(bytes))) << (16 * part);
        }
        mask[w] = ~word;
    }
    return mask;
#else
    return voxelsWhere([=](unsigned i) { return values[i] != one; });
#endif
}

template <typename Leaf>
inline VoxelMask activeVoxelsOf(const Leaf& leaf) {
    VoxelMask mask;
    for (openvdb::Index w = 0; w < 8; ++w)
        mask[w] = leaf.getValueMask().template getWord<openvdb::Index64>(w);
    return mask;
}

/// Calls `visit(position)` for every active voxel of a leaf in order. Rows without gaps run as plain loops of 64, which
/// the compiler can turn into vector instructions.
template <typename Leaf, typename Visit>
inline void forActive(const Leaf& leaf, Visit visit) {
    for (openvdb::Index w = 0; w < 8; ++w) {
        openvdb::Index64 word = leaf.getValueMask().template getWord<openvdb::Index64>(w);
        if (word == ~openvdb::Index64(0)) {
            for (openvdb::Index i = w * 64; i < w * 64 + 64; ++i)
                visit(i);
        } else {
            for (; word; word &= word - 1)
                visit(w * 64 + openvdb::util::FindLowestOn(word));
        }
    }
}

} // namespace patina
