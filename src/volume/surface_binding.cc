#include "volume/surface_binding.h"

#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

namespace patina {

SurfaceBinding::SurfaceBinding(const LayerVolume& volume, const SurfaceMesh& surface, const ClosedSurface& closed)
    : surface_(&surface), scene_(closed.positions, closed.triangles), frontTriangles_(closed.frontTriangles) {
    rebind(volume);
}

void SurfaceBinding::rebind(const LayerVolume& volume) {
    const auto leaves = leavesOf(std::as_const(volume.grids().base->tree()));
    const double voxelSize = volume.scale().voxelSize;
    leafStart_.resize(leaves.size() + 1);
    std::size_t total = 0;
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        leafStart_[n] = total;
        total += leaves[n]->onVoxelCount();
    }
    leafStart_[leaves.size()] = total;
    points_.assign(total, SurfacePoint());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = leafStart_[n];
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            points_[at] = closest(Imath::V3d(c.x(), c.y(), c.z()) * voxelSize);
        }
    });
}

SurfacePoint SurfaceBinding::closest(const Imath::V3d& position) const {
    const auto found = scene_.closest(Imath::V3f(position));
    if (!found || static_cast<std::size_t>(found->point.triangle) >= frontTriangles_)
        return {};
    return found->point;
}

bool SurfaceBinding::occluded(const Imath::V3f& origin, const Imath::V3f& direction) const {
    return scene_.occluded(origin, direction, 0.f, std::numeric_limits<float>::infinity());
}

} // namespace patina
