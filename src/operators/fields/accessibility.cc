#include "operators/fields/accessibility.h"

#include "operators/fields/level_set_point.h"
#include "operators/fields/passages.h"
#include "operators/fields/tangent_spheres.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

namespace patina {

using Imath::V3d;
using Imath::V3f;

namespace {

class LocalSpheres {
  public:
    LocalSpheres(const NestSampler& sampler, int layer, double voxelSize, const SurfaceVoxels& surface, float limit)
        : sampler_(sampler), layer_(layer), voxelSize_(voxelSize), surface_(surface), limit_(limit),
          spheres_(surface.feet, surface.normals) {}

    /// \param guess  what stopped the voxel before; receives what stops this one
    float radius(std::size_t i, int& guess) const {
        const TangentSpheres::Touch touch = spheres_.largest(surface_.feet[i], surface_.normals[i], limit_, guess);
        guess = touch.point;
        return touch.point < 0 ? touch.radius : refined(surface_.feet[i], surface_.normals[i], touch);
    }

  private:
    // The surface between the points: slides what stops the sphere along the level set to where it stands in deepest.
    float refined(const V3f& p, const V3f& normal, const TangentSpheres::Touch& touch) const {
        V3d q(surface_.feet[touch.point]);
        float radius = touch.radius;
        for (int iteration = 0; iteration < 3; ++iteration) {
            const V3d centre = V3d(p) + V3d(normal) * double(radius);
            const V3d facing = levelSetNormal(sampler_, layer_, q);
            V3d along = centre - q;
            along -= facing * along.dot(facing);
            const double length = along.length();
            if (length < 0.02)
                break;
            along *= std::min(length, 0.7) / length;
            const float before = radius;
            for (const double share : {1.0, 0.4, 0.15}) {
                V3d candidate = q + along * share;
                if (!ontoSurface(candidate))
                    continue;
                const float r = TangentSpheres::radiusAt(p, normal, V3f(candidate),
                                                         V3f(levelSetNormal(sampler_, layer_, candidate)));
                if (r < radius) {
                    radius = r;
                    q = candidate;
                    break;
                }
            }
            if (!(radius < 0.999f * before))
                break;
        }
        return radius;
    }

    bool ontoSurface(V3d& point) const {
        for (int i = 0; i < 4; ++i) {
            V3d gradient;
            const double phi = sampler_.valueAndGradient(layer_, sampler_.locate(point), gradient) / voxelSize_;
            gradient /= voxelSize_;
            const double squared = gradient.length2();
            if (squared < 1e-2)
                return false;
            if (phi * phi < 1e-8 * squared)
                return true;
            V3d step = gradient * (-phi / squared);
            if (step.length2() > 1.0)
                return false;
            point += step;
        }
        return true;
    }

    const NestSampler& sampler_;
    int layer_;
    double voxelSize_;
    const SurfaceVoxels& surface_;
    float limit_;
    TangentSpheres spheres_;
};

// The largest sphere at p, no larger than the local one, that can come from outside. Spheres at p are nested, so where
// one can come all smaller ones can.
float fromOutside(const Passages& passages, const V3f& p, const V3f& normal, float local) {
    float reachable = 0.f, tooLarge = local;
    if (passages.reaches(p + normal * local, local))
        return local;
    while (tooLarge - reachable > 0.05f) {
        const float radius = 0.5f * (reachable + tooLarge);
        (passages.reaches(p + normal * radius, radius) ? reachable : tooLarge) = radius;
    }
    return reachable;
}

} // namespace

std::vector<float> accessibleRadii(const LayerVolume& volume, const SurfaceVoxels& surface, int layer,
                                   double limitVoxels, bool global, Progress& progress) {
    const NestSampler sampler(volume.grids());
    const auto limit = static_cast<float>(limitVoxels);
    const LocalSpheres spheres(sampler, layer, volume.scale().voxelSize, surface, limit);
    std::vector<float> radii(surface.size());
    std::unique_ptr<Passages> passages;
    if (global)
        passages = std::make_unique<Passages>(volume, layer, surface, limitVoxels, progress);
    const std::size_t leaves = surface.leafStart.empty() ? 0 : surface.leafStart.size() - 1;
    tbb::parallel_for(std::size_t(0), leaves, [&](std::size_t leaf) {
        if (progress.cancelled())
            return;
        int guess = -1;
        for (std::size_t i = surface.leafStart[leaf]; i < surface.leafStart[leaf + 1]; ++i) {
            radii[i] = spheres.radius(i, guess);
            if (passages)
                radii[i] = fromOutside(*passages, surface.feet[i], surface.normals[i], radii[i]);
        }
    });
    progress.checkpoint();
    return radii;
}

} // namespace patina
