#include "volume/index_space.h"

#include <cmath>

namespace patina {

IndexSpace::IndexSpace(const openvdb::math::Transform& transform) {
    const openvdb::Vec3d first = transform.indexToWorld(openvdb::Vec3d(0.0)), voxel = transform.voxelSize();
    for (int axis = 0; axis < 3; ++axis)
        origin_[axis] = static_cast<int>(std::lround(-first[axis] / voxel[axis]));
}

openvdb::math::Transform::Ptr IndexSpace::transform(double voxelSize, const Imath::V3d& worldOrigin) const {
    auto transform = openvdb::math::Transform::createLinearTransform(voxelSize);
    const openvdb::Vec3d first = openvdb::Vec3d(worldOrigin.x, worldOrigin.y, worldOrigin.z) - origin_.asVec3d() * voxelSize;
    if (first != openvdb::Vec3d(0.0))
        transform->postTranslate(first);
    return transform;
}

} // namespace patina
