#pragma once
// A level set read tricubically (Catmull-Rom), so that what is measured is the field's error and not the reader's.

#include "volume/nest_grids.h"

#include <Imath/ImathVec.h>

#include <cmath>

namespace patina::test {

class SmoothReader {
  public:
    /// \param grid  of a whole model
    explicit SmoothReader(const openvdb::FloatGrid& grid, double voxelSize = 1.0)
        : accessor_(grid.getConstAccessor()), space_(grid.transform()), inverse_(1.0 / voxelSize) {}

    /// The value in voxels at a place in voxels.
    double at(const Imath::V3d& p) const {
        const Imath::V3i low(int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z)));
        const openvdb::Coord c = space_.index(low);
        double w[3][4];
        for (int a = 0; a < 3; ++a) {
            const double t = p[a] - low[a], t2 = t * t, t3 = t2 * t;
            w[a][0] = 0.5 * (-t3 + 2.0 * t2 - t);
            w[a][1] = 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0);
            w[a][2] = 0.5 * (-3.0 * t3 + 4.0 * t2 + t);
            w[a][3] = 0.5 * (t3 - t2);
        }
        double sum = 0.0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                for (int k = 0; k < 4; ++k)
                    sum += w[0][i] * w[1][j] * w[2][k] * double(accessor_.getValue(c.offsetBy(i - 1, j - 1, k - 1)));
        return sum * inverse_;
    }

    Imath::V3d gradient(const Imath::V3d& p, double step = 0.05) const {
        Imath::V3d g;
        for (int a = 0; a < 3; ++a) {
            Imath::V3d up = p, down = p;
            up[a] += step;
            down[a] -= step;
            g[a] = (at(up) - at(down)) / (2.0 * step);
        }
        return g;
    }

    /// The zero next to p, found along the gradient.
    Imath::V3d ontoSurface(Imath::V3d p) const {
        for (int i = 0; i < 8; ++i) {
            const Imath::V3d g = gradient(p);
            p -= g * (at(p) / std::max(g.length2(), 0.01));
        }
        return p;
    }

    /// Where a line crosses zero for the first time between `from` and `to` (along the unit direction); NaN: nowhere.
    double crossing(const Imath::V3d& p, const Imath::V3d& direction, double from, double to) const {
        double a = from, fa = at(p + direction * a);
        for (double b = a + 0.25; b < to + 0.25; b += 0.25) {
            const double fb = at(p + direction * b);
            if (fa <= 0.0 && fb > 0.0) {
                for (int i = 0; i < 40; ++i) {
                    const double m = 0.5 * (a + b);
                    (at(p + direction * m) <= 0.0 ? a : b) = m;
                }
                return 0.5 * (a + b);
            }
            a = b;
            fa = fb;
        }
        return std::nan("");
    }

  private:
    openvdb::FloatGrid::ConstAccessor accessor_;
    IndexSpace space_;
    double inverse_;
};

} // namespace patina::test
