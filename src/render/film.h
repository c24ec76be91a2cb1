#pragma once
// From linear light to a picture file.

#include "render/image.h"

#include <filesystem>
#include <map>
#include <string>

namespace patina {

enum class ViewTransform {
    srgb,   ///< clipped at white: colours up to it are exact
    filmic, ///< the same below 0.6, highlights above roll off smoothly and reach white only at infinity
};

struct ViewOptions {
    ViewTransform transform = ViewTransform::filmic;
    float exposureStops = 0.f; ///< light is multiplied by 2 to this power
    /// Adds up to half a step of an 8-bit file, by a fixed pattern over the pixels: smooth backgrounds show no bands.
    bool dither = true;
};

/// Linear Rec.709 light to sRGB-encoded 0…1. Values that are not finite become black.
Image displayImage(const Image& linear, const ViewOptions& options = {});

/// What the shoulder of `filmic` does to one linear component (before the sRGB curve).
float filmicShoulder(float linear);

/// Words for a file: how it was made. No times, so that two runs give the same file.
using ImageMetadata = std::map<std::string, std::string>;

/// Writes an encoded picture (0…1, 1, 3 or 4 channels) as 8-bit PNG, atomically, with its metadata as text chunks.
/// \throws RunError when the picture is empty or the file cannot be written.
void writePng(const Image& encoded, const std::filesystem::path& path, const ImageMetadata& metadata = {});

/// Reads a picture back as encoded 0…1, and its text chunks where asked for.
/// \throws RunError when it cannot be read.
Image readPng(const std::filesystem::path& path, ImageMetadata* metadata = nullptr);

/// Any picture as R, G, B: grey ones threefold, transparent ones over white. Encoded in, encoded out.
Image asRgb(const Image& picture);

} // namespace patina
