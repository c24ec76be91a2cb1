#pragma once
// Where the voxels of a volume stand among a grid's coordinates. Includes OpenVDB: for volume/, operators/ and export/
// sources.

#include "volume/grid_instances.h"

#include <Imath/ImathBox.h>
#include <Imath/ImathVec.h>

namespace patina {

/// Two ways to name a voxel: its *place*, counted in voxels from the model's origin (of a region: from the region's), and
/// its *index*, the coordinates under which the grids hold it: index = place + origin. Places, and positions between
/// them, are what all geometry is computed with; positions times the voxel size are scene units. The origin is taken
/// off as whole numbers, so that a position has the same bits wherever the grids lie.
class IndexSpace {
  public:
    /// Index and place are the same.
    IndexSpace() = default;
    explicit IndexSpace(const openvdb::Coord& origin) : origin_(origin) {}
    /// As a transform without rotation has it, whose world begins at the origin: transform() of the same space.
    explicit IndexSpace(const openvdb::math::Transform& transform);

    /// The index of the voxel at the model's (or region's) origin; multiples of 8 in volumes of this program.
    const openvdb::Coord& origin() const { return origin_; }

    Imath::V3i place(const openvdb::Coord& index) const {
        return {index.x() - origin_.x(), index.y() - origin_.y(), index.z() - origin_.z()};
    }
    /// Of the voxel's middle, in voxels.
    Imath::V3d position(const openvdb::Coord& index) const { return Imath::V3d(place(index)); }

    openvdb::Coord index(const Imath::V3i& place) const {
        return {place.x + origin_.x(), place.y + origin_.y(), place.z + origin_.z()};
    }
    openvdb::Coord index(int x, int y, int z) const { return index(Imath::V3i(x, y, z)); }
    openvdb::CoordBBox index(const Imath::Box3i& places) const { return {index(places.min), index(places.max)}; }

    /// From index to world. \param worldOrigin  where the model's (or region's) origin lies, scene units
    openvdb::math::Transform::Ptr transform(double voxelSize, const Imath::V3d& worldOrigin = Imath::V3d(0.0)) const;

    bool operator==(const IndexSpace& other) const { return origin_ == other.origin_; }

  private:
    openvdb::Coord origin_{0, 0, 0};
};

} // namespace patina
