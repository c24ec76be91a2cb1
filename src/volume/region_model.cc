#include "volume/region_model.h"

#include "base/errors.h"
#include "base/hash.h"
#include "surface/region_charts.h"
#include "surface/region_clip.h"
#include "surface/vertex_normals.h"
#include "volume/region_voxelize.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {

using Imath::Box3d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

// Halving leaves edges of one to two voxels: 1.5 on average, as limit surfaces have.
constexpr double shownEdgeVoxels = 2.0;
// Fine enough that a triangle is either buried in another part of the model or not.
constexpr double workEdgeVoxels = 4.0;
constexpr double cageEdgeVoxels = 1.5;

RayScene localScene(const SurfaceMesh& surface, const Region& region) {
    std::vector<V3f> positions;
    positions.reserve(surface.positions.size());
    for (const V3f& p : surface.positions)
        positions.emplace_back(region.toLocal(V3d(p)));
    return RayScene(positions, surface.triangles);
}

Error noSurface(const Region& region, const SurfaceMesh& whole, const RayScene& scene) {
    const V3d middle = region.localBox().center();
    const auto nearest = scene.closest(V3f(middle));
    const V3d there = nearest ? positionAt(whole, nearest->point) : V3d(0.0);
    const bool inside = whole.closed && isInside(scene, V3f(middle));
    const V3d size = region.box.size();
    return Error(ExitCode::commandLine, "--region",
                 fmt::format("the box holds no surface: it lies wholly {}", inside ? "in the metal" : "in the air"),
                 fmt::format("the surface nearest to its middle is at {:.7g},{:.7g},{:.7g}, {:.3g} scene units away: "
                             "--region-at {:.7g},{:.7g},{:.7g},{:.6g}",
                             there.x, there.y, there.z, nearest ? nearest->distance / region.magnification : 0.0, there.x, there.y, there.z,
                             std::max({size.x, size.y, size.z})));
}

Mesh controlOf(const SurfaceMesh& piece, const std::string& name, const Region& region) {
    Mesh mesh;
    mesh.name = name;
    for (const V3f& p : piece.positions)
        mesh.positions.emplace_back(region.toModel(V3d(p)));
    mesh.uvs = piece.uvs;
    mesh.vertexAttributes = piece.vertexAttributes;
    for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
        mesh.faceSizes.push_back(3);
        for (int c = 0; c < 3; ++c) {
            mesh.faceVertices.push_back(piece.triangles[t][c]);
            mesh.faceUvs.push_back(piece.triangleUvs[t][c]);
        }
    }
    return mesh;
}

SurfaceMesh dicedForShow(const SurfaceMesh& piece, double voxelSize, bool ownNormals) {
    SurfaceMesh shown = diced(piece, shownEdgeVoxels * voxelSize);
    if (ownNormals)
        shown.normals = angleWeightedNormals(shown.positions, shown.triangles);
    return shown;
}

} // namespace

RegionModel::RegionModel(Mesh mesh, const Region& region, const Options& options)
    : mesh_(std::move(mesh)), region_(region), cutter_(mesh_, options.limit),
      wholeScene_(localScene(cutter_.whole(), region)) {
    const double voxelSize = region_.localVoxelSize();
    work_ = cutter_.near(region_.surfaceBox(), region_.origin(), cageEdgeVoxels * region_.voxelSize);
    for (V3f& p : work_.positions)
        p *= static_cast<float>(region_.magnification);
    work_ = clippedTo(work_, region_.local(region_.surfaceBox()));
    if (!cutter_.isSubdivided())
        work_ = diced(work_, workEdgeVoxels * voxelSize);
    if (work_.triangles.empty())
        throw noSurface(region_, whole(), wholeScene_);
    if (work_.closed)
        settleSides(work_, wholeScene_, voxelSize);
    SurfaceMesh piece = clippedTo(work_, region_.localBox());
    if (piece.triangles.empty())
        throw noSurface(region_, whole(), wholeScene_);
    makeProjectedCharts(piece, options.up, options.resolution);
    control_ = controlOf(piece, mesh_.name, region_);
    region_.pieceHash = hashOf(control_);
    shown_ = dicedForShow(piece, voxelSize, !cutter_.isSubdivided());
}

SurfaceMesh RegionModel::growthSurface(double margin, double edge) const {
    const Box3d box = region_.surfaceBox();
    return cutter_.near({box.min - V3d(margin), box.max + V3d(margin)}, V3d(0.0), edge);
}

SurfaceMesh RegionModel::shownFrom(const Mesh& control, const Region& region) {
    LimitSurfaceOptions plain;
    plain.scheme = SubdivisionScheme::none;
    SurfaceMesh piece = makeLimitSurface(control, plain);
    for (V3f& p : piece.positions)
        p = V3f(region.toLocal(V3d(p)));
    return dicedForShow(piece, region.localVoxelSize(), true);
}

std::string RegionModel::hashOf(const Mesh& control) {
    ContentHash hash;
    hash.add(control.positions.data(), control.positions.size() * sizeof(V3f));
    hash.add(control.faceVertices.data(), control.faceVertices.size() * sizeof(int));
    return hash.text();
}

} // namespace patina
