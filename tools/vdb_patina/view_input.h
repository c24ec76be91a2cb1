#pragma once
// Camera and light as they are asked for on a command line.

#include "options.h"

#include "render/camera.h"
#include "render/lights.h"

#include <Imath/ImathBox.h>

#include <functional>
#include <vector>

namespace patina::tool {

/// What the camera is to show, in the picture's own coordinates.
struct Subject {
    const SurfaceMesh* surface = nullptr;
    /// From the model's coordinates, which --closeup is in, to the picture's.
    std::function<Imath::V3f(const Imath::V3d&)> fromModel;
    double unitsPerModelUnit = 1.0; ///< of the picture, a magnified region's being larger
    double metresPerModelUnit = 1.0;
};

struct View {
    Camera camera;
    CameraView from;
    int width = 0, height = 0; ///< pixels
};

/// \throws Error (command line) where --camera or --closeup cannot be read or a close-up meets no surface
View viewOf(const Options& options, const Subject& subject);

/// \throws Error (command line), RunError where a panorama cannot be used
Lights lightsOf(const Options& options, float cameraAzimuthDegrees);

} // namespace patina::tool
