#include "operators/fields/crease_map.h"

#include "operators/fields/plane_fit.h"
#include "operators/fields/voxel_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr float creaseCosine = 0.7f; // of the angle between the normals of neighbours
constexpr int besideRings = 1;       // of voxels around a crease, beyond which no cell read holds both sides
constexpr int fitReach = 2;          // voxels around a point whose values are fitted
constexpr int keptRings = besideRings + 1 + fitReach; // so that no fit lacks the voxels on its far side
constexpr char unreached = 127;

template <typename Visit>
void forNeighbours(const V3i& centre, int radius, Visit&& visit) {
    for (int x = -radius; x <= radius; ++x)
        for (int y = -radius; y <= radius; ++y)
            for (int z = -radius; z <= radius; ++z)
                visit(centre + V3i(x, y, z));
}

struct CreaseVoxels {
    std::vector<V3i> voxels; // no two alike
    std::vector<char> beside;
    std::vector<V3f> points, normals;
    std::vector<float> values;
};

class CreaseMap : public ThicknessMap {
  public:
    CreaseMap(ThicknessMapPtr field, CreaseVoxels voxels, double voxelSize)
        : field_(std::move(field)), near_(std::move(voxels)), table_(near_.voxels), voxelSize_(voxelSize) {}

    double value(const MapPoint& point) const override {
        const auto own = bySide(point.position / voxelSize_, V3f(point.normal));
        return own ? *own : field_->value(point);
    }

  private:
    std::optional<float> bySide(const V3d& p, const V3f& normal) const {
        const V3i low(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
                      static_cast<int>(std::floor(p.z)));
        bool beside = false;
        for (int c = 0; c < 8 && !beside; ++c) {
            const int j = table_.find(low + V3i(c >> 2, (c >> 1) & 1, c & 1));
            beside = j >= 0 && near_.beside[j];
        }
        if (!beside)
            return std::nullopt;
        const V3i middle(static_cast<int>(std::floor(p.x + 0.5)), static_cast<int>(std::floor(p.y + 0.5)),
                         static_cast<int>(std::floor(p.z + 0.5)));
        constexpr double radius2 = 2.5 * 2.5;
        PlaneFit fit(normal);
        forNeighbours(middle, fitReach, [&](const V3i& v) {
            const int j = table_.find(v);
            if (j < 0)
                return;
            const V3f away(V3d(near_.points[j]) - p);
            const double kernel = 1.0 - away.length2() / radius2;
            const double alike = (normal.dot(near_.normals[j]) - 0.9) / 0.1;
            // Narrow, as a plane is wrong by the field's curvature times the square of the width.
            if (kernel > 0.0 && alike > 0.0)
                fit.add(kernel * kernel * kernel * kernel * alike, away, near_.values[j]);
        });
        return fit.weight() > 0.0 ? std::optional<float>(fit.atPoint()) : std::nullopt;
    }

    ThicknessMapPtr field_;
    CreaseVoxels near_;
    VoxelTable table_;
    double voxelSize_;
};

// Of each flat voxel how many neighbours lie between it and a crease, up to keptRings.
std::vector<char> ringsAroundCreases(const SurfaceVoxels& surface, const OpenPlaces& places) {
    const VoxelTable table(surface.voxels);
    std::vector<char> ring(surface.size(), unreached);
    tbb::parallel_for(std::size_t(0), surface.size(), [&](std::size_t i) {
        if (!places.flat[i])
            return;
        forNeighbours(surface.voxels[i], 1, [&](const V3i& v) {
            const int j = table.find(v);
            if (j >= 0 && places.flat[j] && places.normals[i].dot(places.normals[j]) < creaseCosine)
                ring[i] = 0;
        });
    });
    std::vector<std::size_t> front, next;
    for (std::size_t i = 0; i < surface.size(); ++i)
        if (ring[i] == 0)
            front.push_back(i);
    for (int r = 1; r <= keptRings; ++r, front.swap(next)) {
        next.clear();
        for (const std::size_t i : front)
            forNeighbours(surface.voxels[i], 1, [&](const V3i& v) {
                const int j = table.find(v);
                if (j < 0 || !places.flat[j] || ring[j] != unreached)
                    return;
                ring[j] = static_cast<char>(r);
                next.push_back(j);
            });
    }
    return ring;
}

} // namespace

ThicknessMapPtr readBySides(ThicknessMapPtr field, const SurfaceVoxels& surface, const OpenPlaces& places,
                            double voxelSize) {
    if (std::find(places.flat.begin(), places.flat.end(), 1) == places.flat.end())
        return field;
    const std::vector<char> ring = ringsAroundCreases(surface, places);
    CreaseVoxels near;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        if (ring[i] > keptRings)
            continue;
        near.beside.push_back(ring[i] <= besideRings);
        near.voxels.push_back(surface.voxels[i]);
        near.points.push_back(places.points[i]);
        near.normals.push_back(places.normals[i]);
        MapPoint point;
        point.position = V3d(surface.voxels[i]) * voxelSize;
        point.normal = V3d(places.normals[i]);
        near.values.push_back(static_cast<float>(field->value(point)));
    }
    if (near.voxels.empty())
        return field;
    return std::make_shared<CreaseMap>(std::move(field), std::move(near), voxelSize);
}

} // namespace patina
