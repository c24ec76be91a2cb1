#include "operators/maps/geometry_map.h"

#include <algorithm>

namespace patina {

namespace {

class FacingMap : public ThicknessMap {
  public:
    explicit FacingMap(const Imath::V3d& direction) : direction_(direction.normalized()) {}
    double value(const MapPoint& point) const override { return std::clamp(point.normal.dot(direction_), 0.0, 1.0); }

  private:
    Imath::V3d direction_;
};

class ElevationMap : public ThicknessMap {
  public:
    ElevationMap(const Imath::V3d& up, double low, double high) : up_(up), low_(low), range_(high - low) {}
    double value(const MapPoint& point) const override {
        return range_ > 0.0 ? std::clamp((point.position.dot(up_) - low_) / range_, 0.0, 1.0) : 0.0;
    }

  private:
    Imath::V3d up_;
    double low_, range_;
};

} // namespace

ThicknessMapPtr makeSlopeMap(const Imath::V3d& up) {
    return std::make_shared<FacingMap>(up);
}

ThicknessMapPtr makeFacingMap(const Imath::V3d& direction) {
    return std::make_shared<FacingMap>(direction);
}

ThicknessMapPtr makeElevationMap(const Imath::V3d& up, const Imath::Box3d& bounds) {
    // The support of a box in a direction is reached at a corner.
    const Imath::V3d axis = up.normalized();
    double low = 0.0, high = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double a = axis[i] * bounds.min[i], b = axis[i] * bounds.max[i];
        low += std::min(a, b);
        high += std::max(a, b);
    }
    return std::make_shared<ElevationMap>(axis, low, high);
}

} // namespace patina
