#include "operators/maps/context_map.h"

namespace patina {

namespace {

class ContextMap : public ThicknessMap {
  public:
    ContextMap(const ContextFields& fields, int field) : fields_(fields), field_(field) {}
    double value(const MapPoint& point) const override { return fields_.value(field_, point.position); }

  private:
    const ContextFields& fields_;
    int field_;
};

} // namespace

ThicknessMapPtr makeContextMap(const ContextFields& fields, const std::string& name) {
    const int field = fields.find(name);
    return field < 0 ? nullptr : std::make_shared<ContextMap>(fields, field);
}

} // namespace patina
