#include "operators/interface_foot.h"

#include "volume/band.h"
#include "volume/interior_band.h"

#include <cmath>

namespace patina {

bool isThinStack(const LayerVolume& volume) {
    return stackHeightVoxels(volume) < 0.1 && metalDepthVoxels(volume) < 0.1;
}

InterfaceFoot::InterfaceFoot(const Workpiece& work)
    : binding_(work.binding), sampler_(work.volume.grids()), voxelSize_(work.volume.scale().voxelSize),
      thinStack_(isThinStack(work.volume)) {}

InterfaceFoot::Foot InterfaceFoot::find(int k, const openvdb::Coord& coord, std::size_t at) const {
    const Imath::V3d x = sampler_.position(coord);
    Foot foot{x, binding_.at(at)};
    if (foot.under.triangle >= 0)
        foot.position = positionAt(binding_.surface(), foot.under) / voxelSize_;
    if (thinStack_)
        return foot;
    // Newton steps along the gradient bring the point onto the interface, tangential ones under x. Half the tangential
    // step: a whole one overshoots where the interface is curved towards x.
    Imath::V3d& p = foot.position;
    for (int iteration = 0; iteration < 8; ++iteration) {
        Imath::V3d gradient;
        const double phi = sampler_.valueAndGradient(k, sampler_.locate(p), gradient) / voxelSize_;
        gradient /= voxelSize_;
        const double squared = gradient.length2();
        if (squared < 1e-4)
            break;
        const Imath::V3d away = x - p;
        const Imath::V3d tangential = away - gradient * (away.dot(gradient) / squared);
        Imath::V3d step = gradient * (-phi / squared) + tangential * 0.5;
        const double length = step.length();
        if (length > 1.0)
            step /= length;
        p += step;
        if (length < 1e-4)
            break;
    }
    if (foot.under.triangle >= 0)
        foot.under = binding_.closest(p * voxelSize_);
    return foot;
}

} // namespace patina
