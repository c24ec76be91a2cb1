#pragma once
// What a picture shows, apart from its light: colour, direction, distance and layers, for denoisers and compositing.

#include "base/progress.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/scene.h"

#include <cstdint>
#include <functional>

namespace patina {

/// Of a point of the surface.
struct PointFeatures {
    Imath::V3f albedo{0.f};  ///< linear Rec.709
    int material = 0;        ///< the outermost layer that is there: 0 the metal, k layer k from the bottom
    float thicknessUm = 0.f; ///< of all layers together, µm
};
using FeaturesAt = std::function<PointFeatures(const SurfacePoint& point)>;

/// Same size as the picture. Where no surface is seen: 0, and a depth of infinity.
struct Features {
    Image albedo;    ///< mean over the pixel
    Image normal;    ///< mean of the unit shading normals, scene axes
    Image depth;     ///< from the camera to the surface in the pixel's middle, scene units
    Image material;  ///< in the pixel's middle, PointFeatures::material; -1: no surface
    Image thickness; ///< mean, µm
    Image alpha;     ///< part of the pixel that the surface covers
};

/// Means are over `samples` rays spread as the picture's are. The same bits on any number of threads.
/// \throws RunError as render() does; Interrupted
Features renderFeatures(const RenderScene& scene, const FeaturesAt& featuresAt, const Camera& camera, int width,
                        int height, int samples, std::uint64_t seed, Progress& progress);

} // namespace patina
