#pragma once
// Tiled, mip-mapped copies of the maps, as production renderers read them.

#include <filesystem>

namespace patina {

/// Makes the .tx of a map that writeExr() wrote, atomically: OpenEXR inside, tiles of 64 × 64, all mip levels,
/// lossless, the pixels and attributes of the finest level unchanged. \throws RunError
void writeTx(const std::filesystem::path& exr, const std::filesystem::path& tx);

/// The same without a temporary file. \param file  what is written \param tx  what errors name
void makeTx(const std::filesystem::path& exr, const std::filesystem::path& file, const std::filesystem::path& tx);

} // namespace patina
