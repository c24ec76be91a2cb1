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
        for (int x = 0; x < width; ++x) {
            StagePoint point;
            const CameraRay middle = camera.ray((float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height));
            if (stage.intersect(middle.origin, middle.direction, false, point) == StageHit::surface) {
                *features.depth.at(x, y) = (point.position - middle.origin).length();
                *features.material.at(x, y) = float(featuresAt(point.surface).material);
            }
            PixelSampler sampler(random, x, y);
            V3f albedo(0.f), normal(0.f);
            float thickness = 0.f, covered = 0.f;
            for (int sample = 0; sample < samples; ++sample) {
                sampler.startSample(std::uint32_t(sample));
                const V2f in = sampler.next2(), lens = sampler.next2();
                const CameraRay ray =
                    camera.ray((float(x) + in.x) / float(width), (float(y) + in.y) / float(height), lens);
                if (stage.intersect(ray.origin, ray.direction, false, point) != StageHit::surface)
                    continue;
                const PointFeatures here = featuresAt(point.surface);
                albedo += here.albedo;
                normal += point.shading.normal;
                thickness += here.thicknessUm;
                covered += 1.f;
            }
            const float share = 1.f / float(samples);
            features.albedo.setRgb(x, y, albedo * share);
            features.normal.setRgb(x, y, normal * share);
            *features.thickness.at(x, y) = thickness * share;
            *features.alpha.at(x, y) = covered * share;
        }
    });
    progress.checkpoint();
    return features;
}

} // namespace patina
