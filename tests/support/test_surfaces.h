#pragma once
// Surfaces with closed forms for the tests, and a workpiece made of them.

#include "operators/surface_operation.h"
#include "surface/mesh.h"
#include "volume/sheet_back.h"
#include "volume/vdb_file.h"
#include "volume/voxelize.h"

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <utility>

namespace patina::test {

/// A geodesic sphere: an icosahedron split `level` times and pushed out to the radius, with exact normals.
inline SurfaceMesh sphere(float radius, int level) {
    SurfaceMesh surface;
    const float g = 0.5f * (1.f + std::sqrt(5.f));
    const Imath::V3f corners[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    const int faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                              {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                              {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (const auto& corner : corners)
        surface.positions.push_back(corner.normalized());
    for (const auto& face : faces)
        surface.triangles.emplace_back(face[0], face[1], face[2]);
    for (int i = 0; i < level; ++i) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto key = std::minmax(a, b);
            const auto found = middles.find(key);
            if (found != middles.end())
                return found->second;
            surface.positions.push_back((surface.positions[a] + surface.positions[b]).normalized());
            return middles[key] = static_cast<int>(surface.positions.size()) - 1;
        };
        std::vector<Imath::V3i> split;
        for (const Imath::V3i& t : surface.triangles) {
            const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
            split.insert(split.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
        }
        surface.triangles = std::move(split);
    }
    surface.normals = surface.positions;
    for (auto& p : surface.positions)
        p *= radius;
    return surface;
}

/// A flat open sheet of n × n quads in the plane z = 0, facing +z, from the origin to (size, size), UVs the unit
/// square.
inline SurfaceMesh sheet(float size, int n) {
    SurfaceMesh surface;
    surface.closed = false;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            surface.positions.emplace_back(size * i / n, size * j / n, 0.f);
            surface.normals.emplace_back(0.f, 0.f, 1.f);
            surface.uvs.emplace_back(float(i) / n, float(j) / n);
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            surface.triangles.emplace_back(a, b, d);
            surface.triangles.emplace_back(a, d, c);
        }
    surface.triangleUvs = surface.triangles;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        surface.triangleFaces.push_back(static_cast<int>(t / 2));
    return surface;
}

/// Surface, volume and binding that stay together.
struct Piece {
    SurfaceMesh surface;
    ClosedSurface closed;
    std::unique_ptr<LayerVolume> volume;
    std::unique_ptr<SurfaceBinding> binding;
    Progress progress;

    Workpiece work() { return {*volume, *binding}; }
};

/// Voxelises a surface and binds it to its volume.
inline std::unique_ptr<Piece> makePiece(SurfaceMesh surface, VolumeScale scale, double exteriorBand = 4.0) {
    initializeVolumes();
    auto piece = std::make_unique<Piece>();
    piece->surface = std::move(surface);
    piece->closed = closeSurface(piece->surface, sheetBackVoxels * scale.voxelSize);
    VoxelizeOptions options;
    options.scale = scale;
    options.exteriorBand = exteriorBand;
    piece->volume = std::make_unique<LayerVolume>(voxelize(piece->closed, options, piece->progress));
    piece->binding = std::make_unique<SurfaceBinding>(*piece->volume, piece->surface, piece->closed);
    piece->binding->refineBase(*piece->volume);
    return piece;
}

/// One scene unit is a micrometre and a voxel is one scene unit: thicknesses are in voxels.
inline VolumeScale voxelScale() {
    VolumeScale scale;
    scale.voxelSize = 1.0;
    scale.metresPerUnit = 1e-6;
    return scale;
}

/// A map from a plain function.
class FunctionMap : public ThicknessMap {
  public:
    explicit FunctionMap(std::function<double(const MapPoint&)> function) : function_(std::move(function)) {}
    double value(const MapPoint& point) const override { return function_(point); }

  private:
    std::function<double(const MapPoint&)> function_;
};

} // namespace patina::test
