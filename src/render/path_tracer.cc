#include "render/path_tracer.h"

#include "base/errors.h"
#include "render/pixel_sampler.h"
#include "render/stage.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <thread>

namespace patina {

using Imath::V2f;
using Imath::V3f;

namespace {

constexpr int tileSize = 16;
constexpr int blockSize = 4; // whose pixels' camera rays are traced together
static_assert(blockSize * blockSize <= RayScene::packetSize && tileSize % blockSize == 0);
constexpr int drawsPerVertex = 7; // which light, three lights, two for a direction, roulette

float largest(const V3f& c) {
    return std::max({c.x, c.y, c.z});
}

bool isFinite(const V3f& c) {
    return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

float powerHeuristic(float mine, float other) {
    // By the ratio, so that squares of large densities do not overflow.
    const float ratio = other / mine;
    return 1.f / (1.f + ratio * ratio);
}

// A tent over -1…1 by inverting its distribution.
float tent(float u) {
    return u < 0.5f ? std::sqrt(2.f * u) - 1.f : 1.f - std::sqrt(2.f - 2.f * u);
}

// Lights are sampled by radiance times cosine, which is all that a perfectly diffuse surface asks for: there, light met
// by chance would only add noise.
bool leavesLightsToShadowRays(const SeenLambert&) {
    return true;
}
bool leavesLightsToShadowRays(const SeenBsdf&) {
    return false;
}

// One path, from the camera to where its light came from.
class PathWalk {
  public:
    PathWalk(const Stage& stage, const Lights& lights, const RenderOptions& options, PixelSampler& sampler)
        : stage_(stage), lights_(lights), options_(options), sampler_(sampler) {}

    /// \param first  what the camera's ray met
    V3f radiance(const V3f& origin, const V3f& direction, const std::optional<RayScene::Hit>& first);
    std::uint64_t rays() const { return rays_; }

  private:
    /// Light sampled from here, then a direction to go on in. \returns false where the path ends.
    template <typename Bsdf>
    bool scatter(const Bsdf& bsdf, const StagePoint& point);
    /// One shadow ray to one light, chosen with this chance.
    template <typename Bsdf>
    void sampleLight(const Bsdf& bsdf, const StagePoint& point, Lights::Source source, float chance);
    /// The same to the lights in the scene, which are sampled so often that their density counts `share` times.
    template <typename Bsdf>
    void sampleAreaLights(const Bsdf& bsdf, const StagePoint& point, float share);
    /// Light in the scene that the ray passed before it met what is `farthest` away.
    void meetAreaLights(float farthest);
    /// How often the first surface samples them.
    int areaLooks() const { return lights_.hasKey() ? 1 : 2; }
    /// The light of a path that leaves the scene.
    void meetLights();
    void add(V3f light, bool indirect);

    const Stage& stage_;
    const Lights& lights_;
    const RenderOptions& options_;
    PixelSampler& sampler_;
    V3f origin_{0.f}, direction_{0.f};
    V3f light_{0.f};
    V3f throughput_{1.f};
    Lights::Aim aim_;          ///< for the surface that the ray left
    V3f normal_{0.f};          ///< of that surface
    bool lightsDone_ = false;  ///< the surface that the ray left has all direct light already
    float directionPdf_ = 0.f; ///< of the ray, by its BSDF
    int depth_ = 0;
    std::uint64_t rays_ = 0;
};

void PathWalk::add(V3f light, bool indirect) {
    const float most = largest(light);
    if (indirect && most > options_.indirectClamp)
        light *= options_.indirectClamp / most;
    light_ += light;
}

template <typename Bsdf>
void PathWalk::sampleLight(const Bsdf& bsdf, const StagePoint& point, Lights::Source source, float chance) {
    const Lights::Sample towards = lights_.sample(source, aim_, sampler_.next2());
    const V3f wi = point.shading.toLocal(towards.direction);
    const float density = towards.pdf * chance;
    if (!(density > 0.f) || wi.z <= 0.f)
        return;
    const BsdfValue here = bsdf.evaluate(wi);
    const V3f reflected = here.value * (wi.z / density) * towards.radiance;
    if (!(largest(reflected) > 0.f))
        return;
    if (stage_.facesFloor(point, towards.direction))
        return;
    ++rays_;
    if (stage_.blocked(point, towards.direction))
        return;
    const float weight = leavesLightsToShadowRays(bsdf) ? 1.f : powerHeuristic(density, here.pdf);
    add(throughput_ * reflected * weight, depth_ > 0);
}

template <typename Bsdf>
void PathWalk::sampleAreaLights(const Bsdf& bsdf, const StagePoint& point, float share) {
    const AreaLightSet::Sample towards = lights_.area().sample(point.origin, point.shading.normal, sampler_.next2());
    const V3f wi = point.shading.toLocal(towards.direction);
    const float density = towards.pdf * share;
    if (!(density > 0.f) || wi.z <= 0.f)
        return;
    const BsdfValue here = bsdf.evaluate(wi);
    const V3f reflected = here.value * (wi.z / density) * towards.radiance;
    if (!(largest(reflected) > 0.f))
        return;
    ++rays_;
    if (stage_.blocked(point, towards.direction, towards.distance))
        return;
    const float weight = leavesLightsToShadowRays(bsdf) ? 1.f : powerHeuristic(density, here.pdf);
    add(throughput_ * reflected * weight, depth_ > 0);
}

template <typename Bsdf>
bool PathWalk::scatter(const Bsdf& bsdf, const StagePoint& point) {
    const int draw = 1 + depth_ * drawsPerVertex;
    aim_ = lights_.aim(point.shading.normal);
    normal_ = point.shading.normal;
    // At what the camera sees every light is sampled, further on only one of them.
    const float keyChance = lights_.chance(Lights::keyLight), areaChance = lights_.chance(Lights::areaLights);
    if (depth_ == 0) {
        sampler_.seek(draw + 1);
        sampleLight(bsdf, point, Lights::environment, 1.f);
        if (keyChance > 0.f)
            sampleLight(bsdf, point, Lights::keyLight, 1.f);
        for (int look = 0; look < areaLooks() && areaChance > 0.f; ++look)
            sampleAreaLights(bsdf, point, float(areaLooks()));
    } else {
        sampler_.seek(draw);
        const float choice = keyChance > 0.f || areaChance > 0.f ? sampler_.next1() : 1.f;
        sampler_.seek(draw + 1);
        if (choice < areaChance) {
            sampleAreaLights(bsdf, point, areaChance);
        } else {
            const auto source = choice - areaChance < keyChance ? Lights::keyLight : Lights::environment;
            sampleLight(bsdf, point, source, lights_.chance(source));
        }
    }

    sampler_.seek(draw + 4);
    const V2f u = sampler_.next2();
    const BsdfSample next = bsdf.sample({u.x, u.y, sampler_.next1()});
    if (!(next.pdf > 0.f) || !(next.wi.z > 0.f) || !(largest(next.weight) > 0.f))
        return false;
    throughput_ *= next.weight;
    // Roulette from the third surface on: paths that carry little end, the others make up for them.
    if (depth_ >= 2) {
        const float survival = std::min(0.95f, largest(throughput_));
        if (sampler_.next1() >= survival)
            return false;
        throughput_ /= survival;
    }
    lightsDone_ = leavesLightsToShadowRays(bsdf);
    directionPdf_ = next.pdf;
    direction_ = point.shading.toWorld(next.wi).normalized();
    origin_ = point.origin;
    return true;
}

void PathWalk::meetLights() {
    if (lightsDone_)
        return;
    V3f light(0.f);
    for (const auto source : {Lights::environment, Lights::keyLight}) {
        if (source == Lights::keyLight && lights_.chance(source) == 0.f)
            continue;
        // As likely as the shadow ray of the surface that the path comes from was to go this way.
        const float density = lights_.pdf(source, aim_, direction_) * (depth_ == 1 ? 1.f : lights_.chance(source));
        light += lights_.radiance(source, direction_) * powerHeuristic(directionPdf_, density);
    }
    add(throughput_ * light, depth_ > 1);
}

void PathWalk::meetAreaLights(float farthest) {
    if (lightsDone_ || depth_ == 0)
        return;
    const float share = depth_ == 1 ? float(areaLooks()) : lights_.chance(Lights::areaLights);
    V3f light(0.f);
    for (std::size_t k = 0; k < lights_.area().lights().size(); ++k)
        if (const auto hit = lights_.area().hit(k, origin_, normal_, direction_, farthest))
            light += hit->radiance * powerHeuristic(directionPdf_, hit->pdf * share);
    if (largest(light) > 0.f)
        add(throughput_ * light, depth_ > 1);
}

V3f PathWalk::radiance(const V3f& origin, const V3f& direction, const std::optional<RayScene::Hit>& first) {
    origin_ = origin;
    direction_ = direction;
    for (;; ++depth_) {
        ++rays_;
        StagePoint point;
        const StageHit met = depth_ == 0 ? stage_.meet(first, origin_, direction_, false, point)
                                         : stage_.intersect(origin_, direction_, true, point);
        if (!lights_.area().empty() && met != StageHit::inside)
            meetAreaLights(met == StageHit::nothing ? std::numeric_limits<float>::infinity()
                                                    : (point.position - origin_).length());
        switch (met) {
        case StageHit::nothing: {
            if (depth_ == 0)
                return stage_.seenByCamera(lights_, direction_);
            meetLights();
            return light_;
        }
        case StageHit::inside:
            return light_;
        case StageHit::ground: {
            const float far = stage_.backdropShare(point.position);
            if (far > 0.f) {
                add(throughput_ * stage_.backdrop() * far, depth_ > 1);
                throughput_ *= 1.f - far;
            }
            if (far >= 1.f || depth_ >= options_.maxDepth || !scatter(SeenLambert{stage_.groundAlbedo()}, point))
                return light_;
            break;
        }
        case StageHit::surface: {
            if (depth_ >= options_.maxDepth)
                return light_;
            const PatinaBsdf bsdf = stage_.material(point);
            if (!scatter(SeenBsdf(bsdf, point.shading.toLocal(-direction_)), point))
                return light_;
            break;
        }
        }
    }
}

void check(const RenderScene& scene, const RenderOptions& options) {
    if (!scene.surface || scene.surface->triangles.empty())
        throw RunError("picture", "there is no surface to render");
    if (scene.surface->normals.size() != scene.surface->positions.size())
        throw RunError("picture", "the surface has no normals");
    if (!scene.material)
        throw RunError("picture", "the surface has no material");
    if (!(scene.groundAlbedo >= 0.f && scene.groundAlbedo <= 1.f))
        throw RunError("picture", "the floor's albedo must be 0 to 1");
    if (options.width < 1 || options.height < 1 || options.width > 32768 || options.height > 32768)
        throw RunError("picture", "its sides must be 1 to 32768 pixels");
    if (options.samples < 1 || options.samples > 1 << 20)
        throw RunError("picture", "the samples per pixel must be 1 to 1048576");
    if (options.maxDepth < 1 || options.maxDepth > 64)
        throw RunError("picture", "the depth of paths must be 1 to 64");
    if (!(options.indirectClamp > 0.f))
        throw RunError("picture", "the bound of indirect light must be above 0");
}

} // namespace

Rendering render(const RenderScene& scene, const Camera& camera, const Lights& lights, const RenderOptions& options,
                 Progress& progress) {
    check(scene, options);
    const Stage stage(scene, lights);
    if (stage.isInside(camera.position()))
        throw RunError("camera", "it stands inside the object",
                       "move it away: a larger distance, or another direction");
    const KeyedRandom random(options.seed, "picture", "paths");

    Rendering result;
    result.image = Image(options.width, options.height);
    const int across = (options.width + tileSize - 1) / tileSize;
    const int down = (options.height + tileSize - 1) / tileSize;
    std::atomic<std::uint64_t> rays{0};
    const std::thread::id caller = std::this_thread::get_id();
    const int lensDraw = 1 + options.maxDepth * drawsPerVertex; // behind those of the path

    // Adds samples first … last - 1 of each pixel of a block to its sum. The camera's rays go through the block
    // together, one of each pixel.
    const auto sampleBlock = [&](int left, int top, int first, int last) {
        std::vector<PixelSampler> samplers;
        std::vector<Imath::V2i> pixels;
        for (int y = top; y < std::min(top + blockSize, options.height); ++y)
            for (int x = left; x < std::min(left + blockSize, options.width); ++x) {
                pixels.emplace_back(x, y);
                samplers.emplace_back(random, x, y);
            }
        std::uint64_t traced = 0;
        RayScene::Packet packet;
        packet.count = int(pixels.size());
        std::vector<V3f> sums;
        for (const Imath::V2i& pixel : pixels)
            sums.push_back(result.image.rgb(pixel.x, pixel.y));
        for (int sample = first; sample < last; ++sample) {
            for (int i = 0; i < packet.count; ++i) {
                PixelSampler& sampler = samplers[std::size_t(i)];
                sampler.startSample(std::uint32_t(sample));
                const V2f offset = sampler.next2();
                V2f lens(0.5f);
                if (camera.hasLens()) {
                    sampler.seek(lensDraw);
                    lens = sampler.next2();
                }
                const Imath::V2i& pixel = pixels[std::size_t(i)];
                const CameraRay ray =
                    camera.ray((float(pixel.x) + 0.5f + tent(offset.x)) / float(options.width),
                               (float(pixel.y) + 0.5f + tent(offset.y)) / float(options.height), lens);
                packet.origin[i] = ray.origin;
                packet.direction[i] = ray.direction;
            }
            stage.trace(packet);
            for (int i = 0; i < packet.count; ++i) {
                PathWalk walk(stage, lights, options, samplers[std::size_t(i)]);
                const V3f light = walk.radiance(packet.origin[i], packet.direction[i], packet.hit[i]);
                if (isFinite(light))
                    sums[std::size_t(i)] += light;
                traced += walk.rays();
            }
        }
        for (std::size_t i = 0; i < pixels.size(); ++i)
            result.image.setRgb(pixels[i].x, pixels[i].y, sums[i]);
        return traced;
    };
    const auto takeRound = [&](int first, int last) {
        std::atomic<int> done{0};
        tbb::parallel_for(tbb::blocked_range<int>(0, across * down, 1), [&](const tbb::blocked_range<int>& range) {
            for (int tile = range.begin(); tile != range.end(); ++tile) {
                progress.checkpoint();
                const int left = tile % across * tileSize, top = tile / across * tileSize;
                std::uint64_t traced = 0;
                for (int y = top; y < std::min(top + tileSize, options.height); y += blockSize)
                    for (int x = left; x < std::min(left + tileSize, options.width); x += blockSize)
                        traced += sampleBlock(x, y, first, last);
                rays += traced;
                const int finished = ++done;
                // Progress listens to one thread only: the caller's, which works on tiles too.
                if (std::this_thread::get_id() == caller)
                    progress.update((first + double(last - first) * finished / (across * down)) / options.samples);
            }
        });
    };
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const std::clock_t worked = std::clock();
    while (result.samples < options.samples) {
        int next = options.samples;
        if (options.seconds > 0.0) {
            next = std::min(options.samples, std::max(1, 2 * result.samples));
            const double gone = std::chrono::duration<double>(Clock::now() - begin).count();
            if (result.samples > 0 && gone + gone / result.samples * (next - result.samples) > options.seconds)
                break;
        }
        takeRound(result.samples, next);
        result.samples = next;
    }
    for (float& c : result.image.pixels)
        c /= float(result.samples);
    result.rays = rays;
    result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    result.processorSeconds = double(std::clock() - worked) / CLOCKS_PER_SEC;
    return result;
}

} // namespace patina
