#include "operators/growth/nest_relief.h"

#include "volume/nest_grids.h"
#include "volume/nest_sampler.h"
#include "volume/stack_probe.h"

#include <Imath/ImathBox.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace patina {

std::vector<float> nestHeights(const LayerVolume& volume, const GrowthLattice& lattice, const Imath::V3d& origin,
                               double magnification) {
    std::vector<float> heights(lattice.size(), 0.f);
    if (volume.layerCount() == 0)
        return heights;
    const StackProbe probe(volume);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lattice.size(), 512), [&](const auto& range) {
        std::vector<double> um(std::size_t(volume.layerCount()));
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Imath::V3d point = (Imath::V3d(lattice.centres[i]) - origin) * magnification;
            const auto reading = probe.read(point, Imath::V3d(lattice.normals[i]).normalized(), um.data());
            if (reading.found)
                heights[i] = static_cast<float>(std::max(0.0, reading.height));
        }
    });
    return heights;
}

struct NestShadow::Nest {
    NestSampler sampler;
    double voxelSize;
    Imath::Box3d bounds; ///< of the band, voxels

    double distance(const Imath::V3d& voxels) const {
        return sampler.value(sampler.interfaceCount() - 1, sampler.locate(voxels)) / voxelSize;
    }
};

NestShadow::NestShadow(const LayerVolume& volume) {
    const openvdb::CoordBBox box = volume.grids().base->evalActiveVoxelBoundingBox();
    const IndexSpace& space = volume.grids().space;
    nest_.reset(new Nest{NestSampler(volume.grids()), volume.scale().voxelSize,
                         Imath::Box3d(space.position(box.min()), space.position(box.max()))});
}

NestShadow::~NestShadow() = default;

bool NestShadow::falls(const Imath::V3d& point, const Imath::V3d& normal, const Imath::V3d& towards,
                       double clearance) const {
    const Nest& nest = *nest_;
    const double clear = std::max(0.75, clearance / nest.voxelSize); // voxels; below that a ray meets its own surface
    Imath::V3d at = point / nest.voxelSize;
    const auto inside = [&] { return nest.bounds.intersects(at); };
    // Up to where the particle comes to rest: out of the nest along the normal.
    for (double phi = nest.distance(at); phi < clear && inside(); phi = nest.distance(at))
        at += normal * std::max(0.25, phi < 0.0 ? -0.5 * phi : clear - phi);
    // phi may say a little more than the distance where coats followed a steep map.
    while (inside()) {
        const double phi = nest.distance(at);
        if (phi < 0.0)
            return true;
        at += towards * std::max(0.4, 0.7 * phi);
    }
    return false;
}

} // namespace patina
