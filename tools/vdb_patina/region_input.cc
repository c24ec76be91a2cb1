#include "region_input.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace patina::tool {

namespace {

constexpr double fewestVoxels = 8.0; // as --voxels

std::vector<double> numbersIn(const std::string& option, std::string text, std::size_t count, const char* example) {
    const std::string given = text;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream in(text);
    std::vector<double> numbers(count);
    for (double& number : numbers)
        in >> number;
    std::string more;
    const bool all = !in.fail() && std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
    if (!all || in >> more)
        throw Error(ExitCode::commandLine, option, fmt::format("'{}' is not {} numbers", given, count),
                    fmt::format("as in {} {}", option, example));
    return numbers;
}

} // namespace

RegionRequest RegionRequest::of(const LayerVolume& volume, const std::string& file) {
    RegionRequest request;
    if (!volume.provenance.region.empty())
        request.existing = Region::fromText(volume.provenance.region, file);
    return request;
}

std::optional<Imath::Box3d> regionBoxOf(const Options& options) {
    Imath::Box3d box;
    if (!options.region.empty()) {
        const auto n = numbersIn("--region", options.region, 6, "0.01,0.12,0.03,0.02,0.13,0.04");
        box.extendBy(Imath::V3d(n[0], n[1], n[2]));
        box.extendBy(Imath::V3d(n[3], n[4], n[5]));
    } else if (!options.regionAt.empty()) {
        const auto n = numbersIn("--region-at", options.regionAt, 4, "0.01,0.12,0.03,0.0005");
        if (!(n[3] > 0.0))
            throw Error(ExitCode::commandLine, "--region-at", fmt::format("a size of {:g}", n[3]),
                        "the fourth number is the length of the cube's sides, in scene units");
        const Imath::V3d middle(n[0], n[1], n[2]), half(0.5 * n[3]);
        box = Imath::Box3d(middle - half, middle + half);
    } else {
        return std::nullopt;
    }
    const Imath::V3d size = box.size();
    if (!(std::min({size.x, size.y, size.z}) > 0.0))
        throw Error(ExitCode::commandLine, "--region", "the box has no volume: two opposite corners differ in all of x, y, z",
                    "x0,y0,z0,x1,y1,z1 in scene units, or --region-at x,y,z,size");
    return box;
}

double modelVoxelSize(const Imath::Box3d& box, const Options& options) {
    const Imath::V3d size = box.size();
    return options.voxelSize > 0.0 ? options.voxelSize : std::max({size.x, size.y, size.z}) / options.voxels;
}

VolumeScale regionScale(const Imath::Box3d& box, const Options& options) {
    const Imath::V3d size = box.size();
    const double longest = std::max({size.x, size.y, size.z});
    VolumeScale scale;
    scale.metresPerUnit = options.metresPerUnit();
    scale.exaggeration = options.exaggeration;
    scale.voxelSize = modelVoxelSize(box, options);
    if (longest < fewestVoxels * scale.voxelSize * (1.0 - 1e-9))
        throw Error(ExitCode::commandLine, "--voxel-size",
                    fmt::format("the region's longest side of {:.4g} scene units would be {:.2g} voxels", longest,
                                longest / scale.voxelSize),
                    fmt::format("give {:.2g} or less, or use --voxels", longest / 64.0));
    // The volume's units, where the model's are too large for OpenVDB.
    const double magnification = Region::magnificationFor(scale.voxelSize);
    scale.voxelSize *= magnification;
    scale.metresPerUnit /= magnification;
    return scale;
}

} // namespace patina::tool
