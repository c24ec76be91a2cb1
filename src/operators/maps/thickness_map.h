#pragma once
// A factor that varies over the surface.

#include <Imath/ImathVec.h>

#include <memory>

namespace patina {

/// Where on the model a map is asked for its value.
struct MapPoint {
    Imath::V3d position;    ///< on the surface, model space, scene units
    Imath::V3d normal{0.0}; ///< outward, unit; 0 where it is not known
    int triangle = -1;      ///< of the SurfaceMesh
    float u = 0.f;          ///< barycentric weight of the second corner
    float v = 0.f;          ///< barycentric weight of the third corner
};

/// A pure function of the surface point; value() is called from many threads at once.
class ThicknessMap {
  public:
    virtual ~ThicknessMap() = default;
    /// The factor at a point; operators clamp it to 0…1 and warn.
    virtual double value(const MapPoint& point) const = 0;
};

using ThicknessMapPtr = std::shared_ptr<const ThicknessMap>;

} // namespace patina
