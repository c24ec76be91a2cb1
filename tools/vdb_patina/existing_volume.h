#pragma once
// A volume from a file together with the model it was made from.

#include "console.h"
#include "model_input.h"
#include "optics/material_library.h"
#include "options.h"
#include "volume/layer_volume.h"

#include <string>

namespace patina::tool {

struct ExistingVolume {
    LayerVolume volume;
    Model model;
    MaterialLibrary materials;
};

/// The options with the up axis of a volume, where the command line names none.
Options withUpOf(const std::string& volumeFile, Options options);

/// Reads both and checks that they belong together. An empty `modelName` means the control mesh beside the volume.
/// \throws Error, RunError, ModelError
ExistingVolume loadExisting(const std::string& volumeFile, const std::string& modelName, const Options& options,
                            Console& console);

} // namespace patina::tool
