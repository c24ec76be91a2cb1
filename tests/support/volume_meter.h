#pragma once
// The volume within a level set given as a dense field: a meter whose own error is far below that of a sum over voxels.

#include "volume/grid_instances.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina::test {

/// Cubic voxels within the zero set of values on the active voxels of a grid (other voxels: inside where negative).
///
/// In each cell of 8 corners the field is read tricubically (Catmull-Rom) on a finer lattice of n³ points, and each fine
/// cell adds the share of it that lies below zero by the linear ramp that is exact for planes aligned with it and good
/// to second order otherwise.
inline double volumeWithin(const openvdb::FloatGrid& grid, int n = 4) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    auto accessor = grid.getConstAccessor();
    double volume = 0.0;
    std::vector<double> weights(4 * n);
    for (int s = 0; s < n; ++s) {
        const double t = (s + 0.5) / n, t2 = t * t, t3 = t2 * t;
        weights[4 * s] = 0.5 * (-t3 + 2 * t2 - t);
        weights[4 * s + 1] = 0.5 * (3 * t3 - 5 * t2 + 2);
        weights[4 * s + 2] = 0.5 * (-3 * t3 + 4 * t2 + t);
        weights[4 * s + 3] = 0.5 * (t3 - t2);
    }
    const double far = grid.background();
    for (int i = box.min().x() - 1; i <= box.max().x(); ++i)
        for (int j = box.min().y() - 1; j <= box.max().y(); ++j)
            for (int k = box.min().z() - 1; k <= box.max().z(); ++k) {
                const double middle = accessor.getValue({i, j, k});
                if (std::abs(middle) > 3.0 || std::abs(middle) >= far) {
                    volume += middle < 0.0;
                    continue;
                }
                double v[4][4][4];
                for (int a = 0; a < 4; ++a)
                    for (int b = 0; b < 4; ++b)
                        for (int c = 0; c < 4; ++c)
                            v[a][b][c] = accessor.getValue({i + a - 1, j + b - 1, k + c - 1});
                for (int a = 0; a < n; ++a)
                    for (int b = 0; b < n; ++b)
                        for (int c = 0; c < n; ++c) {
                            double value = 0.0;
                            for (int x = 0; x < 4; ++x)
                                for (int y = 0; y < 4; ++y)
                                    for (int z = 0; z < 4; ++z)
                                        value += weights[4 * a + x] * weights[4 * b + y] * weights[4 * c + z] * v[x][y][z];
                            volume += std::clamp(0.5 - value * n, 0.0, 1.0) / (n * n * n);
                        }
            }
    return volume;
}

} // namespace patina::test
