#pragma once
// Camera and light as they are asked for on a command line.

#include "diced_model.h"
#include "model_input.h"
#include "options.h"

#include "render/camera.h"
#include "render/lights.h"

#include <Imath/ImathBox.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace patina::tool {

/// Pictures take the object's proportions between these, those of a photograph: width over height.
constexpr float narrowestAspect = 0.7f, widestAspect = 1.8f;

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
    std::optional<float> patch; ///< the side of a close-up, in the picture's units
    std::shared_ptr<DicedModel> diced;   ///< of a series: left by one picture to the next
    std::optional<Imath::Box3f> setting; ///< what floor and backdrop are placed by; not set: the surface shown
};

/// \throws Error (command line) where --camera or --closeup cannot be read or a close-up meets no surface
View viewOf(const Options& options, const Subject& subject);

/// The view for a series of pictures: framed on the bare model, whatever grows on it later, and on a floor that stays.
View stillViewOf(const Options& options, const Model& model);

/// The studio's table is for what stands on it: under a sheet it would be in the picture's corners and say nothing.
bool takesTurntable(const Options& options, const Imath::Box3f& object);

/// \throws Error (command line), RunError where a panorama cannot be used
/// \param object  that the studio's lights stand around, in the picture's coordinates
Lights lightsOf(const Options& options, float cameraAzimuthDegrees, const Imath::Box3f& object);

} // namespace patina::tool
