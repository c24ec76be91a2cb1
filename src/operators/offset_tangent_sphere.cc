#include "operators/offset_tangent_sphere.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "operators/fields/accessibility.h"
#include "operators/fields/field_grid.h"
#include "operators/nest_layers.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <algorithm>

namespace patina {

namespace {

/// 1 where the sphere is smaller than the radius, 0 where it is larger, over a voxel between. Asked for spheres half a
/// voxel larger than the radius, so that the field is full at the end of that slope.
class SmallerSphere : public ThicknessMap {
  public:
    SmallerSphere(ThicknessMapPtr field, double limitVoxels) : field_(std::move(field)), limitVoxels_(limitVoxels) {}
    double value(const MapPoint& point) const override {
        return std::clamp((1.0 - field_->value(point)) * limitVoxels_, 0.0, 1.0);
    }

  private:
    ThicknessMapPtr field_;
    double limitVoxels_;
};

} // namespace

OperationReport offsetTangentSphere(Workpiece& work, const std::string& material, double radiusSceneUnits,
                                    double thicknessUm, bool global, Progress& progress) {
    if (!(radiusSceneUnits > 0.0))
        throw RunError("offset", "the radius must be larger than 0");
    LayerVolume& volume = work.volume;
    const double limit = radiusSceneUnits / volume.scale().voxelSize + 0.5;
    const int layer = volume.layerCount();
    const SurfaceVoxels surface = findSurfaceVoxels(volume, layer);
    std::vector<float> values = accessibleRadii(volume, surface, layer, limit, global, progress);
    for (float& value : values)
        value = static_cast<float>(std::min(1.0, value / limit));

    // Stored only to be spread over the band; it is not one of the volume's fields.
    const std::string name = "offset_tangent_sphere";
    storeField(volume, name, layer, surface, values);
    const SmallerSphere map(makeFieldMap(volume, name), limit);
    volume.grids().fields.erase(name);
    OperationReport report = coat(work, material, thicknessUm, &map, progress);
    // Where no sphere is smaller nothing was put on.
    if (tidyLayers(volume))
        report.changedIds += updateMaterialIds(volume);
    return report;
}

} // namespace patina
