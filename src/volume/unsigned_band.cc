#include "volume/unsigned_band.h"

#include <openvdb/tools/MeshToVolume.h>

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

} // namespace

openvdb::FloatGrid::Ptr unsignedBand(const ClosedSurface& surface, double voxelSize, float width, Progress& progress) {
    const auto transform = openvdb::math::Transform::createLinearTransform(voxelSize);
    Interrupter interrupter{progress};
    return openvdb::tools::meshToVolume<openvdb::FloatGrid>(interrupter, TriangleAdapter(surface, voxelSize), *transform,
                                                            width, width, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
}

} // namespace patina
