#pragma once
// The model in triangles of about a pixel, kept for the next picture from the same view.

#include "render/displace.h"
#include "surface/mesh.h"

#include <memory>

namespace patina::tool {

/// What pictures of one view have in common: all but light and what lies on the metal.
struct DicedModel {
    const SurfaceMesh* model = nullptr; ///< that it was cut from
    float margin = -1.f;                ///< scene units, of dicing
    float longestEdge = 0.f;            ///< the same; infinite where the model is taken as it is
    SurfaceMesh surface;
    std::unique_ptr<const Displacer> displacer; ///< of the surface
};

} // namespace patina::tool
