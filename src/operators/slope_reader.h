#pragma once
// |grad phi| of one interface at points near a leaf, fast: for operators that move a thin stack evenly.
// Includes OpenVDB: for operators/ sources.

#include "volume/leaf_lattice.h"

#include <Imath/ImathVec.h>

#include <array>
#include <cmath>

namespace patina {

/// Reads slopes around one leaf. The leaf and its 26 neighbours are found once; a point is then eight loads and a few
/// products in single precision (slopes to a millionth, which is a millionth of the thickness moved).
class SlopeReader {
  public:
    /// \param inverseVoxelSize  makes slopes of scene units per voxel those per scene unit
    SlopeReader(const LeafLattice& lattice, const std::vector<const FloatLeaf*>& leaves, std::size_t n,
                float inverseVoxelSize)
        : origin_(leaves[n]->origin()), inverseVoxelSize_(inverseVoxelSize) {
        const openvdb::Coord block(origin_ >> 3);
        for (int i = 0, at = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k, ++at) {
                    const std::int32_t number = lattice.at(block.x() + i - 1, block.y() + j - 1, block.z() + k - 1);
                    around_[at] = number < 0 ? nullptr : leaves[number]->buffer().data();
                }
    }

    /// The slope at a point (voxels), trilinear as NestSampler has it; below 0 where the point is not among the leaves.
    float at(const Imath::V3f& p) const {
        const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
        const int i = int(fx) - origin_.x() + 8, j = int(fy) - origin_.y() + 8, k = int(fz) - origin_.z() + 8;
        if (unsigned(i) >= 23u || unsigned(j) >= 23u || unsigned(k) >= 23u)
            return -1.f;
        const float x = p.x - fx, y = p.y - fy, z = p.z - fz;
        float c[8];
        if ((i & 7) != 7 && (j & 7) != 7 && (k & 7) != 7) {
            const float* leaf = around_[(i >> 3) * 9 + (j >> 3) * 3 + (k >> 3)];
            if (!leaf)
                return -1.f;
            leaf += (i & 7) << 6 | (j & 7) << 3 | (k & 7);
            c[0] = leaf[0], c[1] = leaf[1], c[2] = leaf[8], c[3] = leaf[9];
            c[4] = leaf[64], c[5] = leaf[65], c[6] = leaf[72], c[7] = leaf[73];
        } else {
            for (int n = 0; n < 8; ++n) {
                const int ci = i + (n >> 2), cj = j + ((n >> 1) & 1), ck = k + (n & 1);
                const float* leaf = around_[(ci >> 3) * 9 + (cj >> 3) * 3 + (ck >> 3)];
                if (!leaf)
                    return -1.f;
                c[n] = leaf[(ci & 7) << 6 | (cj & 7) << 3 | (ck & 7)];
            }
        }
        const float z00 = c[1] - c[0], z01 = c[3] - c[2], z10 = c[5] - c[4], z11 = c[7] - c[6];
        const float c00 = c[0] + z * z00, c01 = c[2] + z * z01, c10 = c[4] + z * z10, c11 = c[6] + z * z11;
        const float gx = (c10 + y * (c11 - c10)) - (c00 + y * (c01 - c00));
        const float gy = (c01 - c00) + x * ((c11 - c10) - (c01 - c00));
        const float dz0 = z00 + y * (z01 - z00), dz1 = z10 + y * (z11 - z10);
        const float gz = dz0 + x * (dz1 - dz0);
        return std::sqrt(gx * gx + gy * gy + gz * gz) * inverseVoxelSize_;
    }

  private:
    openvdb::Coord origin_;
    float inverseVoxelSize_;
    std::array<const float*, 27> around_;
};

} // namespace patina
