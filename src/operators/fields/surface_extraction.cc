#include "operators/fields/surface_extraction.h"

#include "volume/nest_grids.h"

#include <openvdb/tools/VolumeToMesh.h>

namespace patina {

RayScene extractSurface(const LayerVolume& volume, int layer) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*volume.grids().nest()[layer], points, triangles, quads, 0.0, 0.0);
    // In voxels of the lattice: a region's transform moves its grids into the model's coordinates.
    const auto& transform = volume.grids().base->transform();
    const double voxelSize = volume.scale().voxelSize;
    std::vector<Imath::V3f> positions;
    positions.reserve(points.size());
    for (const openvdb::Vec3s& p : points) {
        const openvdb::Vec3d index = transform.worldToIndex(p);
        positions.emplace_back(Imath::V3d(index.x(), index.y(), index.z()) * voxelSize);
    }
    std::vector<Imath::V3i> faces;
    faces.reserve(triangles.size() + 2 * quads.size());
    for (const openvdb::Vec3I& t : triangles)
        faces.emplace_back(t[0], t[1], t[2]);
    for (const openvdb::Vec4I& q : quads) {
        faces.emplace_back(q[0], q[1], q[2]);
        faces.emplace_back(q[0], q[2], q[3]);
    }
    return RayScene(positions, faces);
}

} // namespace patina
