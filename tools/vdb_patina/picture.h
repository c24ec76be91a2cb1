#pragma once
// From the command line to a picture: which surface, light, camera and files.

#include "console.h"
#include "model_input.h"
#include "optics/layer_stack.h"
#include "options.h"
#include "render/features.h"
#include "render/scene.h"
#include "view_input.h"
#include "volume/layer_volume.h"

#include <filesystem>

namespace patina::tool {

/// \throws Error (over budget) where even the narrowest picture of the size asked for is too large for memory: known
/// before anything is read
void checkPictureSize(const Options& options);

/// Renders a scene and writes NAME.png and, where asked for, NAME.exr beside it: all pictures of the program end here.
/// \param featuresAt  what the EXR's features say of a point of the scene's surface
/// \throws Error (over budget) for a picture too large for memory
void exposePicture(const RenderScene& scene, const View& view, const FeaturesAt& featuresAt, const Options& options,
                   const std::filesystem::path& file, const std::string& description, Console& console);

/// A picture of a volume's present surface, shaded by its own stack: NAME.png and, where asked for, NAME.exr beside it.
/// \throws Error (command line) where camera or light cannot be read, RunError where they are of no use
void writePicture(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                  const std::filesystem::path& file, Console& console);

} // namespace patina::tool
