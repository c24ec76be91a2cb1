#include "volume/surface_binding.h"

#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <cmath>

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
            // phi_0 is the distance to the model, but for the voxeliser's error.
            const auto radius = static_cast<float>(1.02 * std::abs(*voxel) + 0.1 * voxelSize);
            points_[at] = closest(Imath::V3d(c.x(), c.y(), c.z()) * voxelSize, radius);
        }
    });
}

void SurfaceBinding::refineBase(LayerVolume& volume) const {
    const auto leaves = leavesOf(volume.grids().base->tree());
    const double voxelSize = volume.scale().voxelSize;
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = leafStart_[n];
        for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            const Imath::V3d x = Imath::V3d(c.x(), c.y(), c.z()) * voxelSize;
            double distance;
            if (points_[at].triangle >= 0) {
                distance = (positionAt(*surface_, points_[at]) - x).length();
            } else {
                const auto back = scene_.closest(Imath::V3f(x));
                distance = back ? back->distance : std::abs(*voxel);
            }
            voxel.setValue(std::copysign(static_cast<float>(distance), *voxel));
        }
    });
    updateMaterialIds(volume);
}

SurfacePoint SurfaceBinding::closest(const Imath::V3d& position, float radius) const {
    auto found = scene_.closest(Imath::V3f(position), radius);
    if (!found && radius < std::numeric_limits<float>::infinity())
        found = scene_.closest(Imath::V3f(position));
    if (!found || static_cast<std::size_t>(found->point.triangle) >= frontTriangles_)
        return {};
    return found->point;
}

bool SurfaceBinding::occluded(const Imath::V3f& origin, const Imath::V3f& direction) const {
    return scene_.occluded(origin, direction, 0.f, std::numeric_limits<float>::infinity());
}

} // namespace patina
