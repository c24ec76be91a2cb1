#include "volume/unsigned_band.h"

#include "volume/index_origin.h"
#include "volume/index_space.h"

#include <openvdb/tools/MeshToVolume.h>

#include <vector>

namespace patina {

namespace {

// The triangles in the voxels' own coordinates, as OpenVDB's voxeliser reads them.
class TriangleAdapter {
  public:
    TriangleAdapter(const ClosedSurface& surface, double voxelSize) : surface_(surface), scale_(1.0 / voxelSize) {}

    std::size_t polygonCount() const { return surface_.triangles.size(); }
    std::size_t pointCount() const { return surface_.positions.size(); }
    std::size_t vertexCount(std::size_t) const { return 3; }
    void getIndexSpacePoint(std::size_t polygon, std::size_t vertex, openvdb::Vec3d& position) const {
        const Imath::V3f& p = surface_.positions[surface_.triangles[polygon][static_cast<int>(vertex)]];
        position = openvdb::Vec3d(p.x, p.y, p.z) * scale_;
    }

  private:
    const ClosedSurface& surface_;
    double scale_;
};

// OpenVDB's idea of cancelling, in terms of ours.
struct Interrupter {
    Progress& progress;
    void start(const char* = nullptr) {}
    void end() {}
    bool wasInterrupted(int = -1) { return progress.cancelled(); }
};

// Where the band lies in index space. The triangles are voxelised around the model's origin, where their coordinates are
// most exact, and the leaves moved.
IndexSpace spaceOf(const ClosedSurface& surface, double voxelSize, double width) {
    Imath::Box3d box;
    for (const Imath::V3f& p : surface.positions)
        box.extendBy(Imath::V3d(p) / voxelSize);
    if (!box.isEmpty())
        box = {box.min - Imath::V3d(width), box.max + Imath::V3d(width)};
    const Imath::V3i origin = indexOriginFor(box);
    return IndexSpace(openvdb::Coord(origin.x, origin.y, origin.z));
}

void moveTo(const IndexSpace& space, double voxelSize, openvdb::FloatGrid& grid) {
    std::vector<openvdb::FloatTree::LeafNodeType*> leaves;
    leaves.reserve(grid.tree().leafCount());
    grid.tree().stealNodes(leaves);
    const auto moved = std::make_shared<openvdb::FloatTree>(grid.background());
    for (auto* leaf : leaves) {
        leaf->setOrigin(leaf->origin() + space.origin());
        moved->addLeaf(leaf);
    }
    grid.setTree(moved);
    grid.setTransform(space.transform(voxelSize));
}

} // namespace

openvdb::FloatGrid::Ptr unsignedBand(const ClosedSurface& surface, double voxelSize, float width, Progress& progress) {
    const auto transform = openvdb::math::Transform::createLinearTransform(voxelSize);
    Interrupter interrupter{progress};
    const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        interrupter, TriangleAdapter(surface, voxelSize), *transform, width, width,
        openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    moveTo(spaceOf(surface, voxelSize, width), voxelSize, *grid);
    return grid;
}

} // namespace patina
