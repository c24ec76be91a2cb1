#pragma once
// From --region and --region-at to a box cut out of the model.

#include "options.h"

#include "volume/layer_volume.h"
#include "volume/region.h"

#include <Imath/ImathBox.h>

#include <functional>
#include <optional>
#include <string>

namespace patina::tool {

/// What a command knows of the region that a model is wanted for.
struct RegionRequest {
    std::optional<Region> existing; ///< of a volume that is there already
    /// How far layers and operators reach from the metal, voxels, given the scale; null: 4.
    std::function<double(const VolumeScale&)> reachVoxels;

    /// Of a volume: its own region, if it is one.
    static RegionRequest of(const LayerVolume& volume, const std::string& file);
};

/// The box that the command line asks for, in the model's coordinates. \throws Error (command line)
std::optional<Imath::Box3d> regionBoxOf(const Options& options);

/// The size of a close-up's voxels, scene units of the model.
double modelVoxelSize(const Imath::Box3d& box, const Options& options);

/// The scale of a close-up's volume (see Region::magnification). \throws Error (command line) where that is fewer than 8 voxels, or too many
VolumeScale regionScale(const Imath::Box3d& box, const Options& options);

} // namespace patina::tool
