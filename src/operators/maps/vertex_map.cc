#include "operators/maps/vertex_map.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <vector>

namespace patina {

namespace {

class VertexMap : public ThicknessMap {
  public:
    VertexMap(const SurfaceMesh& surface, const std::vector<float>& values) : surface_(surface), values_(values) {}

    double value(const MapPoint& point) const override {
        const Imath::V3i& corners = surface_.triangles[point.triangle];
        return (1.0 - point.u - point.v) * values_[corners[0]] + point.u * values_[corners[1]] +
               point.v * values_[corners[2]];
    }

  private:
    const SurfaceMesh& surface_;
    const std::vector<float>& values_;
};

} // namespace

ThicknessMapPtr makeVertexMap(const SurfaceMesh& surface, const std::string& attribute) {
    const auto found = surface.vertexAttributes.find(attribute);
    if (found == surface.vertexAttributes.end()) {
        std::string names;
        for (const auto& entry : surface.vertexAttributes)
            names += (names.empty() ? "it has " : ", ") + entry.first;
        throw ModelError("model", fmt::format("has no vertex attribute '{}'", attribute),
                         names.empty() ? "it has none" : names);
    }
    return std::make_shared<VertexMap>(surface, found->second);
}

} // namespace patina
