#include "render/path_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

using Imath::V2f;
using Imath::V3f;

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

float largest(const V3f& c) {
    return std::max({c.x, c.y, c.z});
}

float powerHeuristic(float mine, float other) {
    // By the ratio, so that squares of large densities do not overflow.
    const float ratio = other / mine;
    return 1.f / (1.f + ratio * ratio);
}

// Lights are sampled by radiance times cosine, which is all that a perfectly diffuse surface asks for: there, light met
// by chance would only add noise.
bool leavesLightsToShadowRays(const SeenLambert&) {
    return true;
}
bool leavesLightsToShadowRays(const SeenBsdf&) {
    return false;
}

// How often the first surface samples the lights in the scene.
int areaLooks(const Lights& lights) {
    return lights.hasKey() ? 1 : 2;
}

} // namespace

void PathWalk::add(const V3f& light, bool indirect) {
    const V3f arrives = throughput_ * light;
    const float bound = setting_.options.indirectClamp, most = largest(arrives);
    light_ += indirect && bound > 0.f && most > bound ? arrives * (bound / most) : arrives;
}

template <typename Bsdf>
void PathWalk::lookAt(const Bsdf& bsdf, const StagePoint& point, const V3f& direction, const V3f& radiance,
                      float density, float distance) {
    const V3f wi = point.shading.toLocal(direction);
    if (!(density > 0.f) || wi.z <= 0.f)
        return;
    const BsdfValue here = bsdf.evaluate(wi);
    const V3f reflected = here.value * (wi.z / density) * radiance;
    if (!(largest(reflected) > 0.f) || setting_.stage.setBlocks(point, direction, distance))
        return;
    ++rays_;
    if (setting_.stage.rays().occluded(point.origin, direction, 0.f, distance * 0.9999f)) // a light may touch a surface
        return;
    const float weight = leavesLightsToShadowRays(bsdf) ? 1.f : powerHeuristic(density, here.pdf);
    add(reflected * weight, depth_ > 0);
}

template <typename Bsdf>
bool PathWalk::scatter(const Bsdf& bsdf, const StagePoint& point) {
    const Lights& lights = setting_.lights;
    PixelSampler& sampler = sampler_;
    const int draw = 1 + depth_ * drawsPerVertex;
    aim_ = lights.aim(point.shading.normal);
    normal_ = point.shading.normal;
    const auto lookFar = [&](Lights::Source source, float chance) {
        const Lights::Sample towards = lights.sample(source, aim_, sampler.next2());
        lookAt(bsdf, point, towards.direction, towards.radiance, towards.pdf * chance, infinite);
    };
    // Lights in the scene are sampled so often that their density counts `share` times.
    const auto lookNear = [&](float share) {
        const AreaLightSet::Sample towards = lights.area().sample(point.origin, normal_, sampler.next2());
        lookAt(bsdf, point, towards.direction, towards.radiance, towards.pdf * share, towards.distance);
    };
    // At what the camera sees every light is sampled, further on only one of them.
    const float keyChance = lights.chance(Lights::keyLight), areaChance = lights.chance(Lights::areaLights);
    if (depth_ == 0) {
        sampler.seek(draw + 1);
        lookFar(Lights::environment, 1.f);
        if (keyChance > 0.f)
            lookFar(Lights::keyLight, 1.f);
        for (int look = 0; look < areaLooks(lights) && areaChance > 0.f; ++look)
            lookNear(float(areaLooks(lights)));
    } else {
        sampler.seek(draw);
        const float choice = keyChance > 0.f || areaChance > 0.f ? sampler.next1() : 1.f;
        sampler.seek(draw + 1);
        if (choice < areaChance) {
            lookNear(areaChance);
        } else {
            const auto source = choice - areaChance < keyChance ? Lights::keyLight : Lights::environment;
            lookFar(source, lights.chance(source));
        }
    }

    sampler.seek(draw + 4);
    const V2f u = sampler.next2();
    const BsdfSample next = bsdf.sample({u.x, u.y, sampler.next1()});
    if (!(next.pdf > 0.f) || !(next.wi.z > 0.f) || !(largest(next.weight) > 0.f))
        return false;
    throughput_ *= next.weight;
    // Roulette from the third surface on: paths that carry little end, the others make up for them.
    if (depth_ >= 2) {
        const float survival = std::min(0.95f, largest(throughput_));
        if (sampler.next1() >= survival)
            return false;
        throughput_ /= survival;
    }
    lightsDone_ = leavesLightsToShadowRays(bsdf);
    directionPdf_ = next.pdf;
    direction_ = unit(point.shading.toWorld(next.wi));
    origin_ = point.origin;
    ++depth_;
    return true;
}

void PathWalk::meetLights() {
    if (lightsDone_)
        return;
    V3f light(0.f);
    const Lights& lights = setting_.lights;
    for (const auto source : {Lights::environment, Lights::keyLight}) {
        if (source == Lights::keyLight && lights.chance(source) == 0.f)
            continue;
        // As likely as the shadow ray of the surface that the path comes from was to go this way.
        const float density = lights.pdf(source, aim_, direction_) * (depth_ == 1 ? 1.f : lights.chance(source));
        light += lights.radiance(source, direction_) * powerHeuristic(directionPdf_, density);
    }
    add(light, depth_ > 1);
}

void PathWalk::meetAreaLights(float farthest) {
    if (lightsDone_ || depth_ == 0)
        return;
    V3f light(0.f);
    const AreaLightSet& area = setting_.lights.area();
    const float share = depth_ == 1 ? float(areaLooks(setting_.lights)) : setting_.lights.chance(Lights::areaLights);
    for (std::size_t k = 0; k < area.lights().size(); ++k)
        if (const auto hit = area.hit(k, origin_, normal_, direction_, farthest))
            light += hit->radiance * powerHeuristic(directionPdf_, hit->pdf * share);
    add(light, depth_ > 1);
}

V3f PathWalk::radiance(const std::optional<RayScene::Hit>& first) {
    ++rays_;
    bool goesOn = arrive(first);
    while (goesOn) {
        ++rays_;
        const float reach = setting_.stage.reach(origin_, direction_);
        goesOn = arrive(setting_.stage.rays().intersect(origin_, direction_, 0.f, reach));
    }
    return light_;
}

bool PathWalk::arrive(const std::optional<RayScene::Hit>& hit) {
    const Stage& stage = setting_.stage;
    StagePoint point;
    const StageHit met = stage.meet(hit, origin_, direction_, depth_ > 0, point);
    if (!setting_.lights.area().empty() && met != StageHit::inside)
        meetAreaLights(met == StageHit::nothing ? infinite : (point.position - origin_).length());
    switch (met) {
    case StageHit::nothing:
        if (depth_ == 0)
            light_ = stage.seenByCamera(setting_.lights, direction_);
        else
            meetLights();
        return false;
    case StageHit::inside:
        return false;
    case StageHit::ground: {
        const float far = stage.backdropShare(point.position);
        if (far > 0.f) {
            add(stage.backdrop() * far, depth_ > 1);
            throughput_ *= 1.f - far;
        }
        return far < 1.f && depth_ < setting_.options.maxDepth && scatter(SeenLambert{stage.groundAlbedo()}, point);
    }
    case StageHit::surface: {
        if (depth_ >= setting_.options.maxDepth)
            return false;
        const PatinaBsdf bsdf = stage.material(point);
        return scatter(SeenBsdf(bsdf, point.shading.toLocal(-direction_)), point);
    }
    }
    return false;
}

} // namespace patina
