#pragma once
// |grad phi| of one interface at points near a leaf, fast: for operators that move a thin stack evenly.
// Includes OpenVDB: for operators/ sources.

#include "volume/leaf_lattice.h"

#include <Imath/ImathVec.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
                    around_[at] = number < 0 ? nothing() : leaves[number]->buffer().data();
                }
    }

    /// The slopes at some points (voxels), trilinear as NestSampler has it; below 0 where a point is not among the
    /// leaves. Values are gathered for a batch of points, then all its slopes are worked out in one plain loop.
    void read(const Imath::V3f* points, std::size_t count, float* slopes) const {
        for (std::size_t done = 0; done < count; done += batch) {
            const auto n = static_cast<unsigned>(std::min(count - done, batch));
            readBatch(points + done, n, slopes + done);
        }
    }

  private:
    static constexpr std::size_t batch = 64;

    void readBatch(const Imath::V3f* points, unsigned count, float* slopes) const {
        float x[batch], y[batch], z[batch], c[8][batch];
        for (unsigned n = 0; n < count; ++n) {
            const Imath::V3f& p = points[n];
            const int px = floorOf(p.x), py = floorOf(p.y), pz = floorOf(p.z);
            x[n] = p.x - float(px), y[n] = p.y - float(py), z[n] = p.z - float(pz);
            gather(px - origin_.x() + 8, py - origin_.y() + 8, pz - origin_.z() + 8, n, c);
        }
        const float inverseVoxelSize = inverseVoxelSize_;
        for (unsigned n = 0; n < count; ++n) {
            const float z00 = c[1][n] - c[0][n], z01 = c[3][n] - c[2][n];
            const float z10 = c[5][n] - c[4][n], z11 = c[7][n] - c[6][n];
            const float c00 = c[0][n] + z[n] * z00, c01 = c[2][n] + z[n] * z01;
            const float c10 = c[4][n] + z[n] * z10, c11 = c[6][n] + z[n] * z11;
            const float gx = (c10 + y[n] * (c11 - c10)) - (c00 + y[n] * (c01 - c00));
            const float gy = (c01 - c00) + x[n] * ((c11 - c10) - (c01 - c00));
            const float dz0 = z00 + y[n] * (z01 - z00), dz1 = z10 + y[n] * (z11 - z10);
            const float gz = dz0 + x[n] * (dz1 - dz0);
            const float slope = std::sqrt(gx * gx + gy * gy + gz * gz) * inverseVoxelSize;
            slopes[n] = slope >= 0.f ? slope : -1.f;
        }
    }

    // Without a call: the baseline instruction set has no rounding.
    static int floorOf(float v) {
        const int i = static_cast<int>(v);
        return i - (v < static_cast<float>(i));
    }

    // The values at a cell's corners; i, j, k from one leaf below this one. Without a branch on whether the cell lies
    // in one leaf, which a third of them do not.
    void gather(int i, int j, int k, unsigned n, float (&c)[8][batch]) const {
        if (unsigned(i) >= 23u || unsigned(j) >= 23u || unsigned(k) >= 23u) {
            for (auto& corner : c)
                corner[n] = std::numeric_limits<float>::quiet_NaN();
            return;
        }
        const int leafX[2] = {(i >> 3) * 9, ((i + 1) >> 3) * 9}, leafY[2] = {(j >> 3) * 3, ((j + 1) >> 3) * 3};
        const int leafZ[2] = {k >> 3, (k + 1) >> 3};
        const int x[2] = {(i & 7) << 6, ((i + 1) & 7) << 6}, y[2] = {(j & 7) << 3, ((j + 1) & 7) << 3};
        const int z[2] = {k & 7, (k + 1) & 7};
        for (int at = 0; at < 8; ++at) {
            const int u = at >> 2, v = (at >> 1) & 1, w = at & 1;
            c[at][n] = around_[leafX[u] + leafY[v] + leafZ[w]][x[u] + y[v] + z[w]];
        }
    }

    // What is read where there is no leaf: not a number, and neither is the slope there.
    static const float* nothing() {
        static const auto values = [] {
            std::array<float, 512> all;
            all.fill(std::numeric_limits<float>::quiet_NaN());
            return all;
        }();
        return values.data();
    }

    openvdb::Coord origin_;
    float inverseVoxelSize_;
    std::array<const float*, 27> around_;
};

} // namespace patina
