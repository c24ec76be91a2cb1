#pragma once
// A picture with all its features as one OpenEXR file.

#include "render/features.h"
#include "render/film.h"

#include <filesystem>

namespace patina {

/// Channels by the names that compositing programs know: R, G, B (light, linear Rec.709), A; with features also
/// albedo.R/G/B, N.X/Y/Z, Z (depth), material and thickness (µm). Light, albedo and normal are half, the rest float.
/// ZIP compressed, written atomically. \param features  null: light alone
/// \throws RunError where sizes differ or the file cannot be written
void writeExrPicture(const Image& light, const Features* features, const std::filesystem::path& path,
                     const ImageMetadata& metadata = {});

} // namespace patina
