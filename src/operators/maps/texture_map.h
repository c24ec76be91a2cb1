#pragma once
// An image over the model's UVs: the paper's "rectangular texture maps" (§3.3).

#include "operators/maps/thickness_map.h"
#include "surface/mesh.h"

#include <filesystem>
#include <string>

namespace patina {

/// Reads any image OpenImageIO reads. `channel` is a channel's name ("R", "Y", …), its number from 0, or "" for the
/// luminance of a colour image (Rec.709) and the only channel of a grey one. Values are taken as stored (8 bits as 0…1,
/// no colour conversion). Sampled bilinearly; the image repeats outside the unit square; v points up. \throws
/// ModelError where the surface has no UVs; RunError where the image or its channel cannot be read
ThicknessMapPtr makeTextureMap(const SurfaceMesh& surface, const std::filesystem::path& file,
                               const std::string& channel);

} // namespace patina
