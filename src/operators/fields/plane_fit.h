#pragma once
// A plane through values at places around a point of the surface, read at that point.

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

/// A mean would do in the middle of a wall; beside its edge all neighbours lie on one side, and it would be their
/// value.
class PlaneFit {
  public:
    /// \param normal  unit, of the surface at the point
    explicit PlaneFit(const Imath::V3f& normal)
        : s_(normal.cross(std::abs(normal.x) < 0.6f ? Imath::V3f(1, 0, 0) : Imath::V3f(0, 1, 0)).normalized()),
          t_(normal.cross(s_)) {}

    /// \param away  from the point, in voxels
    void add(double weight, const Imath::V3f& away, float value) {
        const double x = away.dot(s_), y = away.dot(t_);
        w_ += weight;
        x_ += weight * x, y_ += weight * y, v_ += weight * value;
        xx_ += weight * x * x, xy_ += weight * x * y, yy_ += weight * y * y;
        xv_ += weight * x * value, yv_ += weight * y * value;
        least_ = std::min(least_, value);
        most_ = std::max(most_, value);
    }

    double weight() const { return w_; }

    /// Within the values that were added, of which there must be one.
    float atPoint() const {
        const double x = x_ / w_, y = y_ / w_, v = v_ / w_;
        constexpr double stiffness = 0.02; // voxels²: few neighbours in a line make no plane
        const double xx = xx_ / w_ - x * x + stiffness, yy = yy_ / w_ - y * y + stiffness, xy = xy_ / w_ - x * y;
        const double xv = xv_ / w_ - x * v, yv = yv_ / w_ - y * v;
        const double determinant = xx * yy - xy * xy;
        const double slopeX = (yy * xv - xy * yv) / determinant, slopeY = (xx * yv - xy * xv) / determinant;
        return std::clamp(static_cast<float>(v - slopeX * x - slopeY * y), least_, most_);
    }

  private:
    Imath::V3f s_, t_;
    double w_ = 0.0, x_ = 0.0, y_ = 0.0, v_ = 0.0, xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, xv_ = 0.0, yv_ = 0.0;
    float least_ = std::numeric_limits<float>::max(), most_ = std::numeric_limits<float>::lowest();
};

} // namespace patina
