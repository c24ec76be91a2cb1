#pragma once
// Maps as OpenEXR files: one map per file, channels Y or R, G, B, lossless.

#include "optics/colour.h"

#include <Imath/half.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace patina {

/// A square map with its name and what it means. Exactly one of `floats` and `halves` holds the pixels, interleaved,
/// row 0 at the top.
struct MapImage {
    std::string name; ///< the file's stem: "displacement", "thickness_01_tarnish_1"
    int size = 0;
    int channels = 1;      ///< 1 (Y) or 3 (R, G, B)
    bool isColour = false; ///< linear light of `colourSpace`; otherwise data
    ColourSpace colourSpace = ColourSpace::rec709;
    std::vector<float> floats;
    std::vector<Imath::half> halves;
    std::vector<std::pair<std::string, std::string>> texts; ///< attributes of the file
    std::vector<std::pair<std::string, float>> numbers;     ///< attributes of the file
};

/// Writes one map atomically, ZIP compressed. \throws RunError
void writeExr(const MapImage& map, const std::filesystem::path& path);

/// Reads a file that writeExr() wrote. \throws RunError
MapImage readExr(const std::filesystem::path& path);

} // namespace patina
