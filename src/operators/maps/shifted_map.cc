#include "operators/maps/shifted_map.h"

#include <utility>

namespace patina {

namespace {

class ShiftedMap : public ThicknessMap {
  public:
    ShiftedMap(ThicknessMapPtr map, double scale, const Imath::V3d& shift)
        : map_(std::move(map)), scale_(scale), shift_(shift) {}
    double value(const MapPoint& point) const override {
        MapPoint moved = point;
        moved.position = point.position * scale_ + shift_;
        return map_->value(moved);
    }

  private:
    ThicknessMapPtr map_;
    double scale_;
    Imath::V3d shift_;
};

} // namespace

ThicknessMapPtr makeShiftedMap(ThicknessMapPtr map, double scale, const Imath::V3d& shift) {
    return map ? std::make_shared<ShiftedMap>(std::move(map), scale, shift) : nullptr;
}

} // namespace patina
