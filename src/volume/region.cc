#include "volume/region.h"

#include "base/errors.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace patina {

namespace {

Imath::Box3d larger(const Imath::Box3d& box, double by) {
    return {box.min - Imath::V3d(by), box.max + Imath::V3d(by)};
}

} // namespace

double Region::marginVoxels() const {
    // Next to the cut, slopes are read across missing voxels (two), and a line along a normal may lean towards it.
    return std::ceil(reachVoxels) + 4.0;
}

Imath::Box3d Region::voxelBox() const {
    return larger(box, marginVoxels() * voxelSize);
}

Imath::Box3i Region::voxelSides() const {
    const Imath::Box3d voxels = local(voxelBox());
    Imath::Box3i sides;
    for (int i = 0; i < 3; ++i) {
        sides.min[i] = static_cast<int>(std::ceil(voxels.min[i] / localVoxelSize()));
        sides.max[i] = static_cast<int>(std::floor(voxels.max[i] / localVoxelSize()));
    }
    return sides;
}

Imath::Box3d Region::surfaceBox() const {
    return larger(voxelBox(), (std::ceil(reachVoxels) + 3.0) * voxelSize);
}

std::string Region::text() const {
    return fmt::format("box {} {} {} {} {} {} origin {} {} {} voxel {} magnification {} reach {} piece {}", box.min.x, box.min.y,
                       box.min.z, box.max.x, box.max.y, box.max.z, originVoxels.x, originVoxels.y, originVoxels.z,
                       voxelSize, magnification, reachVoxels, pieceHash.empty() ? "-" : pieceHash);
}

Region Region::fromText(const std::string& text, const std::string& file) {
    Region region;
    std::istringstream in(text);
    std::string word;
    in >> word >> region.box.min.x >> region.box.min.y >> region.box.min.z >> region.box.max.x >> region.box.max.y >>
        region.box.max.z;
    in >> word >> region.originVoxels.x >> region.originVoxels.y >> region.originVoxels.z;
    in >> word >> region.voxelSize >> word >> region.magnification;
    in >> word >> region.reachVoxels >> word >> region.pieceHash;
    if (!in || !(region.voxelSize > 0.0) || !(region.magnification >= 1.0) || region.box.isEmpty() || !(region.reachVoxels >= 0.0))
        throw RunError(file, "its metadata 'patina_region' is damaged");
    if (region.pieceHash == "-")
        region.pieceHash.clear();
    return region;
}

double Region::magnificationFor(double voxelSize) {
    constexpr double smallest = 2e-5; // OpenVDB wants a voxel's volume above 1e-15
    double magnification = 1.0;
    while (voxelSize * magnification < smallest && magnification < 1e12)
        magnification *= 1024.0;
    return magnification;
}

Region makeRegion(const Imath::Box3d& box, double voxelSize, double reachVoxels) {
    Region region;
    region.box = box;
    region.voxelSize = voxelSize;
    region.magnification = Region::magnificationFor(voxelSize);
    region.reachVoxels = reachVoxels;
    const Imath::V3d middle = box.center() / voxelSize;
    // Keys of random numbers hold eight times a voxel's index.
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(middle[i]) < double(1 << 27)))
            throw RunError("region",
                           fmt::format("voxels of {:.3g} scene units are too small so far from the model's origin",
                                       voxelSize),
                           "use larger voxels, or move the model closer to its origin");
    // Whole leaves of 8 voxels: the lattice's blocks stay those of the model.
    for (int i = 0; i < 3; ++i)
        region.originVoxels[i] = 8 * static_cast<int>(std::lround(middle[i] / 8.0));
    return region;
}

} // namespace patina
