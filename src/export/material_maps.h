#pragma once
// Which of the baked maps a material of another program reads.

#include "optics/colour.h"

#include <string>

namespace patina {

/// The flattened set (docs/export.md): one lobe, as Standard Surface and UsdPreviewSurface have it.
struct MaterialMaps {
    bool baked = false;
    std::string folder = "."; ///< of the maps, relative to the file that names them
    ColourSpace colourSpace = ColourSpace::rec709;
    float maxDisplacement = 0.f; ///< max |h|, scene units: renderers pad bounds by it

    bool severalTiles = false; ///< the files are NAME.1001.exr …, NAME.<UDIM>.exr together

    std::string path(const std::string& map) const {
        return folder + "/" + map + (severalTiles ? ".<UDIM>.exr" : ".exr");
    }
};

/// A name as USD and MaterialX take it: letters, digits and '_', no digit first.
std::string identifierOf(const std::string& name);

} // namespace patina
