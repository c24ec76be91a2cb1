#include "operators/maps/combined_map.h"

#include <array>
#include <cmath>

namespace patina {

namespace {

class ConstantMap : public ThicknessMap {
  public:
    explicit ConstantMap(double value) : value_(value) {}
    double value(const MapPoint&) const override { return value_; }

  private:
    double value_;
};

class CombinedMap : public ThicknessMap {
  public:
    CombinedMap(std::vector<ThicknessMapPtr> maps, std::function<double(const double*)> function)
        : maps_(std::move(maps)), function_(std::move(function)) {}

    double value(const MapPoint& point) const override {
        std::array<double, 8> values;
        const std::size_t count = std::min(maps_.size(), values.size());
        for (std::size_t i = 0; i < count; ++i)
            values[i] = maps_[i]->value(point);
        const double result = function_(values.data());
        return std::isfinite(result) ? result : 0.0;
    }

  private:
    std::vector<ThicknessMapPtr> maps_; // at most 8: no function of the language takes more than five
    std::function<double(const double*)> function_;
};

} // namespace

ThicknessMapPtr makeConstantMap(double value) {
    return std::make_shared<ConstantMap>(value);
}

ThicknessMapPtr makeCombinedMap(std::vector<ThicknessMapPtr> maps, std::function<double(const double*)> function) {
    return std::make_shared<CombinedMap>(std::move(maps), std::move(function));
}

} // namespace patina
