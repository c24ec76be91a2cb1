// The light of paths: what they sample at surfaces, and what they meet.

#include "render/path_batch.h"
#include "render/path_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

// How often the first surface samples the lights in the scene.
int areaLooks(const Lights& lights) {
    return lights.hasKey() ? 1 : 2;
}

} // namespace

void PathBatch::add(int path, const V3f& throughput, const V3f& light, bool indirect) {
    const V3f arrives = throughput * light;
    const float bound = setting_.options.indirectClamp, most = largest(arrives);
    const V3f sum = light_[std::size_t(path)];
    light_.set(std::size_t(path), sum + (indirect && bound > 0.f && most > bound ? arrives * (bound / most) : arrives));
}

void PathBatch::leaveScene() {
    const Lights& lights = setting_.lights;
    std::size_t count = 0; // of those that the environment lights
    if (const auto seen = setting_.stage.seenByCamera(); depth_ == 0 && seen) {
        for (const std::size_t ray : leaving_)
            light_.set(std::size_t(wave_.path[ray]), *seen);
        return;
    }
    for (const std::size_t ray : leaving_) {
        if (!lights.area().empty())
            meetAreaLights(ray, infinite);
        if (depth_ > 0 && wave_.lightsDone[ray])
            continue;
        direction_.set(count, wave_.rays.direction[ray]);
        leavingAims_[count] = wave_.aims[ray];
        leaving_[count++] = ray;
    }
    for (std::size_t i = count; i < BsdfBatch::padded(count); ++i) {
        direction_.set(i, direction_[0]);
        leavingAims_[i] = leavingAims_[0];
    }
    lights.environmentRadiance({count, numbersOf(std::as_const(direction_)), numbersOf(radiance_)});
    if (depth_ == 0) {
        for (std::size_t i = 0; i < count; ++i)
            light_.set(std::size_t(wave_.path[leaving_[i]]),
                       radiance_[i] + lights.radiance(Lights::keyLight, direction_[i]));
        return;
    }
    // As likely as the shadow ray of the surface that the path comes from was to go this way.
    if (lights.isEven())
        for (std::size_t i = 0; i < count; ++i)
            density_[i] = lights.pdf(Lights::environment, {-1, wave_.normal[leaving_[i]]}, direction_[i]);
    else
        lights.environmentDensity({count, leavingAims_.data(), numbersOf(std::as_const(direction_)), density_.data()});
    const auto share = [&](Lights::Source source) { return depth_ == 1 ? 1.f : lights.chance(source); };
    const float ofEnvironment = share(Lights::environment), ofKey = share(Lights::keyLight);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t ray = leaving_[i];
        const float pdf = wave_.directionPdf[ray];
        V3f light = radiance_[i] * powerHeuristic(pdf, density_[i] * ofEnvironment);
        if (lights.chance(Lights::keyLight) > 0.f) {
            const V3f direction = direction_[i];
            const float density = lights.pdf(Lights::keyLight, {-1, direction}, direction) * ofKey;
            light += lights.radiance(Lights::keyLight, direction) * powerHeuristic(pdf, density);
        }
        add(wave_.path[ray], wave_.throughput[ray], light, depth_ > 1);
    }
}

void PathBatch::meetAreaLights(std::size_t ray, float farthest) {
    if (depth_ == 0 || wave_.lightsDone[ray])
        return;
    V3f light(0.f);
    const AreaLightSet& area = setting_.lights.area();
    const float share = depth_ == 1 ? float(areaLooks(setting_.lights)) : setting_.lights.chance(Lights::areaLights);
    for (std::size_t k = 0; k < area.lights().size(); ++k)
        if (const auto hit =
                area.hit(k, wave_.rays.origin[ray], wave_.normal[ray], wave_.rays.direction[ray], farthest))
            light += hit->radiance * powerHeuristic(wave_.directionPdf[ray], hit->pdf * share);
    add(wave_.path[ray], wave_.throughput[ray], light, depth_ > 1);
}

void PathBatch::lookAtLights() {
    bsdfs_.seenFrom(wo_);
    shadows_.count = 0;
    shadowPath_.clear();
    const Lights& lights = setting_.lights;
    const int draw = 1 + depth_ * drawsPerVertex;
    const float keyChance = lights.chance(Lights::keyLight), areaChance = lights.chance(Lights::areaLights);
    const auto lookAll = [&](int number, Lights::Source source, int part = 0, int parts = 1) {
        std::fill_n(sources_.begin(), lanes_, source);
        look(number, part, parts);
    };
    // At what the camera sees every light is sampled, further on only one of them.
    if (depth_ == 0) {
        int number = draw + 1;
        lookAll(number++, Lights::environment);
        if (keyChance > 0.f)
            lookAll(number++, Lights::keyLight);
        for (int i = 0; i < areaLooks(lights) && areaChance > 0.f; ++i)
            lookAll(number, Lights::areaLights, i, areaLooks(lights));
    } else if (keyChance > 0.f || areaChance > 0.f) {
        sampler_.draw(draw, path_, lanes_, numbers_.x.data(), numbers_.y.data());
        for (std::size_t i = 0; i < lanes_; ++i) {
            const float choice = numbers_.x[i];
            sources_[i] = choice < areaChance               ? Lights::areaLights
                          : choice - areaChance < keyChance ? Lights::keyLight
                                                            : Lights::environment;
        }
        look(draw + 1);
    } else {
        lookAll(draw + 1, Lights::environment);
    }
    setting_.stage.rays().occluded(shadows_, blocked_);
    rays_ += shadows_.count;
    for (std::size_t i = 0; i < shadows_.count; ++i)
        if (const auto path = std::size_t(shadowPath_[i]); !blocked_[i])
            light_.set(path, light_[path] + shadowLight_[i]);
}

void PathBatch::sampleLight(std::size_t lane) {
    const Lights& lights = setting_.lights;
    const Lights::Source source = sources_[lane];
    const V2f u(numbers_.x[lane], numbers_.y[lane]);
    // Lights in the scene are sampled so often at the first surface that their density counts so many times.
    const bool area = source == Lights::areaLights;
    const float share = depth_ > 0 ? lights.chance(source) : area ? float(areaLooks(lights)) : 1.f;
    if (area) {
        const AreaLightSet::Sample towards = lights.area().sample(at_.origin[lane], at_.normal[lane], u);
        direction_.set(lane, towards.direction);
        radiance_.set(lane, towards.radiance);
        density_[lane] = towards.pdf * share;
        distance_[lane] = towards.distance;
    } else {
        const Lights::Sample towards = lights.sample(source, {aims_[lane], at_.normal[lane]}, u);
        direction_.set(lane, towards.direction);
        radiance_.set(lane, towards.radiance);
        density_[lane] = towards.pdf * share;
        distance_[lane] = infinite;
    }
}

void PathBatch::look(int draw, int part, int parts) {
    const Stage& stage = setting_.stage;
    const std::size_t padded = BsdfBatch::padded(lanes_);
    sampler_.draw(draw, path_, lanes_, numbers_.x.data(), numbers_.y.data(), part, parts);
    const Lights& lights = setting_.lights;
    const bool together = std::all_of(sources_.begin(), sources_.begin() + std::ptrdiff_t(lanes_),
                                      [](Lights::Source source) { return source == Lights::environment; }) &&
                          (depth_ == 0 || lights.chance(Lights::environment) == 1.f);
    if (together && lights.isEven()) {
        const V3f sky = lights.radiance(Lights::environment, {0, 0, 1});
        skyLanes({padded, numbersOf(std::as_const(at_.normal)), numbers_.x.data(), numbers_.y.data(),
                  numbersOf(direction_), density_.data()});
        std::fill_n(radiance_.x.begin(), padded, sky.x);
        std::fill_n(radiance_.y.begin(), padded, sky.y);
        std::fill_n(radiance_.z.begin(), padded, sky.z);
        std::fill_n(distance_.begin(), padded, infinite);
    } else if (together) {
        lights.sampleEnvironment(
            {lanes_, aims_.data(), numbers_.x.data(), numbers_.y.data(), numbersOf(direction_), density_.data()},
            numbersOf(radiance_));
        std::fill_n(distance_.begin(), padded, infinite);
    } else {
        for (std::size_t i = 0; i < lanes_; ++i)
            sampleLight(i);
    }
    localLanes({padded, at_.frames(), numbersOf(std::as_const(direction_)), numbersOf(wi_)});
    bsdfs_.evaluate(wi_, value_, pdf_);
    arriveLanes({padded, numbersOf(std::as_const(wi_)), numbersOf(std::as_const(value_)),
                 numbersOf(std::as_const(radiance_)), numbersOf(std::as_const(throughput_)), pdf_.data(),
                 density_.data(), lightsDone_.data(), depth_ > 0 ? setting_.options.indirectClamp : 0.f,
                 numbersOf(arriving_), most_.data()});
    shadowLight_.resize(std::max(shadowLight_.size(), shadows_.count + lanes_));
    for (std::size_t i = 0; i < lanes_; ++i) {
        if (!(most_[i] > 0.f))
            continue;
        const V3f origin = at_.origin[i], direction = direction_[i];
        if (stage.setBlocks(origin, direction, distance_[i]))
            continue;
        shadowLight_.set(shadows_.count, arriving_[i]);
        shadowPath_.push_back(path_[i]);
        shadows_.add(origin, direction, distance_[i] * 0.9999f); // a light may touch a surface
    }
}

} // namespace patina
