#include "volume/surface_binding.h"

#include "volume/material_ids.h"
#include "volume/nest_sampler.h"

#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// Whether there is metal on both sides of a triangle, three quarters of a voxel from its corners and its middle.
// (Both sides are asked, so that a model turned inside out keeps its surface.)
bool isBuried(const NestSampler& sampler, const ClosedSurface& closed, const Imath::V3i& triangle, double voxelSize) {
    const Imath::V3d a(closed.positions[triangle[0]]), b(closed.positions[triangle[1]]),
        c(closed.positions[triangle[2]]);
    const Imath::V3d normal = (b - a).cross(c - a).normalized() * 0.75;
    for (const Imath::V3d& p : {(a + b + c) / 3.0, a, b, c})
        for (const double side : {1.0, -1.0})
            if (sampler.value(0, sampler.locate(p / voxelSize + normal * side)) > 0.0)
                return false;
    return true;
}

} // namespace

SurfaceBinding::SurfaceBinding(const LayerVolume& volume, const SurfaceMesh& surface, ClosedSurface closed)
    : surface_(&surface), closed_(std::move(closed)) {
    findVisible(volume);
    rebind(volume);
}

void SurfaceBinding::findVisible(const LayerVolume& volume) {
    const NestSampler sampler(volume.grids());
    std::vector<char> buried(closed_.triangles.size());
    tbb::parallel_for(std::size_t(0), buried.size(), [&](std::size_t t) {
        buried[t] = isBuried(sampler, closed_, closed_.triangles[t], volume.scale().voxelSize);
    });
    const bool none = std::find(buried.begin(), buried.end(), 0) == buried.end();
    std::vector<int> visible;
    std::vector<Imath::V3i> triangles;
    for (std::size_t t = 0; t < buried.size(); ++t)
        if (none || !buried[t]) {
            visible.push_back(static_cast<int>(t));
            triangles.push_back(closed_.triangles[t]);
        }
    if (scene_ && visible == visible_)
        return;
    visible_ = std::move(visible);
    scene_.emplace(closed_.positions, triangles);
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

void SurfaceBinding::refineBase(LayerVolume& volume) {
    NestGrids& grids = volume.grids();
    const auto leaves = leavesOf(grids.base->tree());
    const double voxelSize = volume.scale().voxelSize;
    const double deepest = (grids.interiorBand + 0.5) * voxelSize;
    const float inside = -grids.base->background();
    std::vector<char> left(leaves.size(), 0);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::size_t at = leafStart_[n];
        for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel, ++at) {
            const openvdb::Coord c = voxel.getCoord();
            const Imath::V3d x = Imath::V3d(c.x(), c.y(), c.z()) * voxelSize;
            double distance;
            if (points_[at].triangle >= 0) {
                distance = (positionAt(*surface_, points_[at]) - x).length();
            } else {
                const auto back = scene_->closest(Imath::V3f(x));
                distance = back ? back->distance : std::abs(*voxel);
            }
            if (*voxel < 0.f && distance > deepest) {
                leaves[n]->setValueOff(voxel.pos(), inside);
                left[n] = 1;
            } else {
                voxel.setValue(std::copysign(static_cast<float>(distance), *voxel));
            }
        }
    });
    if (std::find(left.begin(), left.end(), 1) != left.end()) {
        openvdb::tools::pruneLevelSet(grids.base->tree());
        auto tree = std::make_shared<openvdb::Int32Tree>(grids.base->tree(), 0, openvdb::TopologyCopy());
        grids.material->setTree(tree);
        // Bound anew to the grid as it now is, so that a volume read from a file is bound alike.
        findVisible(volume);
        rebind(volume);
    }
    updateMaterialIds(volume);
}

SurfacePoint SurfaceBinding::closest(const Imath::V3d& position, float radius) const {
    auto found = scene_->closest(Imath::V3f(position), radius);
    if (!found && radius < std::numeric_limits<float>::infinity())
        found = scene_->closest(Imath::V3f(position));
    if (!found)
        return {};
    SurfacePoint point = found->point;
    point.triangle = visible_[point.triangle];
    return static_cast<std::size_t>(point.triangle) < closed_.frontTriangles ? point : SurfacePoint();
}

bool SurfaceBinding::occluded(const Imath::V3f& origin, const Imath::V3f& direction) const {
    return scene_->occluded(origin, direction, 0.f, std::numeric_limits<float>::infinity());
}

} // namespace patina
