#pragma once
// Volumes in and out as .vdb: grids `base`, `surface`, `interface_01_…`, `material`, fields; metadata `patina_…`.

#include "volume/layer_volume.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patina {

/// Starts OpenVDB; to be called once before anything of volume/ is used. Safe to call again.
void initializeVolumes();

struct VolumeFileOptions {
    bool halfFields = false; ///< fields (exposure, wetness, …) in half precision: three digits, and smaller files
    std::string up;          ///< the model's up axis, "y" or "z"; empty: not said
};

/// Writes a volume atomically. Level sets are single precision (half would destroy films of 0.001 voxel).
/// \throws RunError when it cannot be written.
void writeVolume(const LayerVolume& volume, const std::filesystem::path& path, const VolumeFileOptions& options = {});

/// The up axis that a volume was written with; empty where it says none. \throws RunError as readVolume() does
std::string upAxisOf(const std::filesystem::path& path);

/// Reads what writeVolume() wrote, bit for bit but for fields in half precision.
/// \throws RunError naming the file, the grid and what was expected.
LayerVolume readVolume(const std::filesystem::path& path);

/// \throws RunError where a file is not a whole volume as writeVolume() wrote it.
void checkVolumeFile(const std::filesystem::path& path);

/// What stands in a .vdb: one line per grid for `info`.
struct GridSummary {
    std::string name;
    std::string type; ///< "float", "int32"
    std::string gridClass;
    std::size_t activeVoxels = 0;
    std::size_t bytes = 0;
};
std::vector<GridSummary> summarizeGrids(const LayerVolume& volume);

} // namespace patina
