#include "render/features.h"

#include "base/errors.h"
#include "render/pixel_sampler.h"
#include "render/stage.h"

#include <tbb/parallel_for.h>

#include <limits>

namespace patina {

using Imath::V2f;
using Imath::V3f;

Features renderFeatures(const RenderScene& scene, const FeaturesAt& featuresAt, const Camera& camera, int width,
                        int height, int samples, std::uint64_t seed, Progress& progress) {
    if (!scene.surface || scene.surface->triangles.empty() || !featuresAt)
        throw RunError("picture", "there is no surface to render");
    if (width < 1 || height < 1 || samples < 1)
        throw RunError("picture", "its sides and samples must be 1 or more");
    RenderScene alone = scene;
    alone.ground = false;
    const Stage stage(alone);
    const KeyedRandom random(seed, "picture", "features");
    constexpr float infinite = std::numeric_limits<float>::infinity();
    Features features{Image(width, height, 3),       Image(width, height, 3), Image(width, height, 1, infinite),
                      Image(width, height, 1, -1.f), Image(width, height, 1), Image(width, height, 1)};
    tbb::parallel_for(0, height, [&](int y) {
        if (progress.cancelled())
            return;
        // A row at once: of each pixel the ray through its middle, then those of its samples.
        RayBatch rays;
        const auto aim = [&](const CameraRay& ray) { rays.add(ray.origin, ray.direction, infinite); };
        for (int x = 0; x < width; ++x) {
            aim(camera.ray((float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height)));
            PixelSampler sampler(random, x, y);
            for (int sample = 0; sample < samples; ++sample) {
                sampler.startSample(std::uint32_t(sample));
                const V2f in = sampler.next2(), lens = sampler.next2();
                aim(camera.ray((float(x) + in.x) / float(width), (float(y) + in.y) / float(height), lens));
            }
        }
        HitBatch hits;
        stage.rays().intersect(rays, true, hits);
        std::vector<int> from;
        for (std::size_t ray = 0; ray < rays.count; ++ray)
            if (hits.triangle[ray] >= 0)
                from.push_back(int(ray));
        if (from.empty())
            return;
        const std::size_t seen = from.size(), padded = BsdfBatch::padded(seen);
        from.resize(padded, from.front());
        SurfaceLanes at;
        VectorLanes wo;
        at.resize(padded);
        wo.resize(padded);
        stage.shade(rays, hits, from, seen, at, wo);
        const float share = 1.f / float(samples);
        for (std::size_t i = 0; i < seen; ++i) {
            const auto ray = std::size_t(from[i]);
            const int x = int(ray / std::size_t(samples + 1));
            const PointFeatures here = featuresAt({hits.triangle[ray], hits.u[ray], hits.v[ray]});
            if (ray % std::size_t(samples + 1) == 0) {
                *features.depth.at(x, y) = (at.position[i] - rays.origin[ray]).length();
                *features.material.at(x, y) = float(here.material);
                continue;
            }
            features.albedo.setRgb(x, y, features.albedo.rgb(x, y) + here.albedo * share);
            features.normal.setRgb(x, y, features.normal.rgb(x, y) + at.normal[i] * share);
            *features.thickness.at(x, y) += here.thicknessUm * share;
            *features.alpha.at(x, y) += share;
        }
    });
    progress.checkpoint();
    return features;
}

} // namespace patina
