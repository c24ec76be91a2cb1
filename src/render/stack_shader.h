#pragma once
// The look of a point of the model, read from the volume itself: what pictures are shaded with.

#include "optics/layer_stack.h"
#include "optics/patina_bsdf.h"
#include "render/features.h"
#include "surface/mesh.h"
#include "volume/stack_probe.h"

#include <vector>

namespace patina {

/// The stack along the base's normal at a surface point, as thicknesses, height and BSDF. Safe from any thread; valid
/// while volume, surface and optics are.
class StackShader {
  public:
    /// \param optics  of [metal, layer 1, … layer n] of the volume
    StackShader(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics);

    PatinaBsdf bsdf(const SurfacePoint& point) const;
    PointFeatures features(const SurfacePoint& point) const;

    /// Height of the air's interface above the base at every vertex, scene units as drawn in the volume.
    std::vector<float> vertexHeights() const;

  private:
    /// Of this thread, until the next call. \param thicknessUm  receives each layer's
    const Appearance& look(const SurfacePoint& point, float* thicknessUm) const;

    const SurfaceMesh& surface_;
    const StackOptics& optics_;
    StackProbe probe_;
};

} // namespace patina
