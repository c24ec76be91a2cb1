#include "operators/fields/surface_voxels.h"

#include "operators/fields/level_set_point.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace patina {

namespace {

const openvdb::Coord neighbours[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

// The crossing on the lattice edges of a voxel that is nearest to it, as an offset; false where no edge is crossed
// closer to this end than to the other. Along an edge the trilinear field is linear, so the crossing is exact.
bool nearestCrossing(const NestSampler& sampler, int layer, const openvdb::Coord& c, float phi, Imath::V3d& offset) {
    double best = 2.0;
    for (const openvdb::Coord& step : neighbours) {
        const float other = sampler.voxel(layer, c + step);
        if ((phi <= 0.f) == (other <= 0.f) || std::abs(other) < std::abs(phi))
            continue;
        const double share = phi == 0.f ? 0.0 : double(phi) / (double(phi) - double(other));
        if (share < best) {
            best = share;
            offset = Imath::V3d(step.x(), step.y(), step.z()) * share;
        }
    }
    return best <= 1.0;
}

} // namespace

SurfaceVoxels findSurfaceVoxels(const LayerVolume& volume, int layer) {
    const NestGrids& grids = volume.grids();
    const NestSampler sampler(grids);
    const auto leaves = leavesOf(std::as_const(grids.nest()[layer]->tree()));
    const double voxelSize = volume.scale().voxelSize;
    const float reach = static_cast<float>(3.0 * voxelSize);

    std::vector<SurfaceVoxels> found(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        SurfaceVoxels& here = found[n];
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel) {
            if (std::abs(*voxel) > reach)
                continue;
            const openvdb::Coord c = voxel.getCoord();
            Imath::V3d offset;
            if (!nearestCrossing(sampler, layer, c, *voxel, offset))
                continue;
            const Imath::V3d x = grids.space.position(c);
            Imath::V3d foot = x;
            if (!levelSetFoot(sampler, layer, voxelSize, x, foot) || (foot - x).length() > 1.2)
                foot = x + offset;
            here.voxels.push_back(grids.space.place(c));
            here.feet.emplace_back(foot);
            here.normals.emplace_back(levelSetNormal(sampler, layer, foot));
        }
    });

    SurfaceVoxels all;
    all.leafStart.assign(leaves.size() + 1, 0);
    for (std::size_t n = 0; n < leaves.size(); ++n)
        all.leafStart[n + 1] = all.leafStart[n] + found[n].size();
    const std::size_t total = all.leafStart.back();
    all.voxels.resize(total);
    all.feet.resize(total);
    all.normals.resize(total);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        std::copy(found[n].voxels.begin(), found[n].voxels.end(), all.voxels.begin() + all.leafStart[n]);
        std::copy(found[n].feet.begin(), found[n].feet.end(), all.feet.begin() + all.leafStart[n]);
        std::copy(found[n].normals.begin(), found[n].normals.end(), all.normals.begin() + all.leafStart[n]);
    });
    return all;
}

} // namespace patina
