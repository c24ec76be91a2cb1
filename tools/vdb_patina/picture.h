#pragma once
// From the command line to a picture: which surface, light, camera and files.

#include "console.h"
#include "model_input.h"
#include "optics/layer_stack.h"
#include "options.h"
#include "volume/layer_volume.h"

#include <filesystem>

namespace patina::tool {

/// A picture of a volume's present surface, shaded by its own stack: NAME.png and, where asked for, NAME.exr beside it.
/// \throws Error (command line) where camera or light cannot be read, RunError where they are of no use
void writePicture(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                  const std::filesystem::path& file, Console& console);

} // namespace patina::tool
