#pragma once
// What a material looks like by its thickness, and its spectrum, as one picture.

#include "optics/material_library.h"
#include "render/image.h"

#include <string>

namespace patina::tool {

struct Swatch {
    Image image; ///< encoded for display
    bool hasText = true;
    double opaqueUm = 0.0; ///< where a thicker layer over copper differs by less than CIEDE2000 1; 0 of metals
};

/// Of a layer: strips of 0 µm … opaque over copper and over a micrometre of another layer on copper, as lit from
/// everywhere; the first 150 nm with their interference where the index is known; and the reflectance spectrum of an
/// opaque one. Of a metal: its colour and spectrum.
/// \param over  the other layer
/// \throws Error (exit 2) where there is no such material, or `over` is a metal
Swatch makeSwatch(const MaterialLibrary& library, const std::string& name, const std::string& over);

} // namespace patina::tool
