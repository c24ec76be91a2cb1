#pragma once
// The flattened maps as MaterialX materials (.mtlx): Standard Surface.
//
//   NAME         displaced: displacement.exr moves the surface, in scene units
//   NAME_normal  for renderers that do not displace: normal.exr bends the normals instead
//
// One or the other: renderers that displace would show the relief twice with both.

#include "export/material_maps.h"

#include <filesystem>
#include <string>

namespace patina {

std::string materialXText(const std::string& name, const MaterialMaps& maps);

/// Writes it atomically. \throws RunError
void writeMaterialX(const std::string& name, const MaterialMaps& maps, const std::filesystem::path& path);

} // namespace patina
