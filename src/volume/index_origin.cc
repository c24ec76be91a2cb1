#include "volume/index_origin.h"

#include <cmath>

namespace patina {

Imath::V3i indexOriginFor(const Imath::Box3d& voxels) {
    constexpr double lowerNode = 128.0, middleOfUpperNode = 2048.0;
    Imath::V3i origin(0);
    if (voxels.isEmpty())
        return origin;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = voxels.min[axis], high = voxels.max[axis];
        const bool odd = std::fmod(std::ceil((high - low) / lowerNode), 2.0) == 1.0;
        const double middle = middleOfUpperNode + (odd ? 0.5 * lowerNode : 0.0);
        origin[axis] = 8 * static_cast<int>(std::lround((middle - 0.5 * (low + high)) / 8.0));
    }
    return origin;
}

} // namespace patina
