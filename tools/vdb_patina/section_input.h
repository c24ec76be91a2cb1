#pragma once
// A core sample as it is asked for on a command line or in a figure.

#include "console.h"

#include "optics/material_library.h"
#include "render/section_picture.h"
#include "render/stack_graph.h"
#include "volume/layer_volume.h"
#include "volume/region.h"

#include <optional>
#include <string>

namespace patina::tool {

/// Words as typed; empty ones are chosen by the volume.
struct SectionInput {
    std::string at;    ///< "x,y,z", the model's scene units; empty: where the stack is most like its mean
    std::string along; ///< "x,y,z"; empty: 1,0,0
    std::string width; ///< a length: µm, or with a unit; empty: 48 voxels
    double stretch = 0.0;
    bool inPlace = false; ///< the plane as it is instead of the surface unrolled
    bool byId = false; ///< a colour for each layer instead of its own
};

/// \param region  of a volume that is a close-up
/// \throws Error (command line) where the words cannot be read, RunError where there is no metal
SectionPicture makeSection(const LayerVolume& volume, const MaterialLibrary& materials, const SectionInput& input,
                           int pictureWidth, const std::string& title, Console& console,
                           const std::optional<Region>& region = {});

/// The stack along the normal at the section's place.
StackGraph makeStackGraph(const LayerVolume& volume, const MaterialLibrary& materials, const SectionInput& input,
                          int pictureWidth, const std::string& title, Console& console,
                          const std::optional<Region>& region = {});

} // namespace patina::tool
