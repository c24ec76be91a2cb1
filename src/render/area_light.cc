#include "render/area_light.h"

#include "base/errors.h"
#include "base/turns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

using Imath::V2f;
using Imath::V3f;

namespace {

constexpr float pi = float(M_PI);

float luminance(const V3f& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

float smoothStep(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.f, 1.f);
    return t * t * (3.f - 2.f * t);
}

// A place -1…1, as likely as a soft edge of this width is bright there: 1 - smoothStep(1 - edge, 1, |place|).
float softPlace(float random, float edge) {
    const float x = 2.f * random - 1.f;
    const float inward = std::abs(x) * (1.f - 0.5f * edge);
    if (inward <= 1.f - edge)
        return std::copysign(inward, x);
    // What lies further out, in edges: w³ - w⁴ / 2 at w from the rim. Newton's steps come down to it from above.
    const float outward = std::max(0.f, 0.5f - (inward - (1.f - edge)) / edge);
    float w = std::cbrt(2.f * outward);
    for (int i = 0; i < 4 && w > 1e-4f; ++i)
        w -= (w * w * w * (1.f - 0.5f * w) - outward) / (w * w * (3.f - 2.f * w));
    return std::copysign(1.f - edge * w, x);
}

// Of a light's plane, -1…1 each, evenly over its shape but for a soft edge. Discs by Shirley and Chiu's concentric map,
// which keeps neighbours neighbours.
V2f pointOn(const AreaLight& light, const V2f& random) {
    if (light.shape == AreaLight::Shape::rectangle && light.softEdge > 0.f)
        return {softPlace(random.x, light.softEdge), softPlace(random.y, light.softEdge)};
    const V2f p(2.f * random.x - 1.f, 2.f * random.y - 1.f);
    if (light.shape == AreaLight::Shape::rectangle || (p.x == 0.f && p.y == 0.f))
        return p;
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float r = wide ? p.x : p.y;
    const CirclePoint around = circlePoint(wide ? 0.125f * p.y / p.x : 0.25f - 0.125f * p.x / p.y);
    return {r * around.cosine, r * around.sine};
}

float meanLuminance(const AreaLight& light) {
    if (light.shape == AreaLight::Shape::disc)
        return luminance(light.radiance);
    constexpr int looks = 16;
    float sum = 0.f;
    for (int i = 0; i < looks * looks; ++i)
        sum += luminance(light.radianceAt((float(i % looks) + 0.5f) / looks, (float(i / looks) + 0.5f) / looks));
    return sum / (looks * looks);
}

} // namespace

float AreaLight::area() const {
    return shape == Shape::disc ? pi * halfWidth * halfWidth : 4.f * halfWidth * halfHeight;
}

float AreaLight::edgeShare(float u, float v) const {
    if (edge() == 0.f)
        return 1.f;
    return (1.f - smoothStep(1.f - softEdge, 1.f, std::abs(u))) * (1.f - smoothStep(1.f - softEdge, 1.f, std::abs(v)));
}

V3f AreaLight::radianceAt(float u, float v) const {
    if (shape == Shape::disc)
        return u * u + v * v <= 1.f ? radiance : V3f(0.f);
    u = std::abs(u), v = std::abs(v);
    if (u > 1.f || v > 1.f)
        return V3f(0.f);
    return radiance * ((1.f - dimming * std::min(u * u + v * v, 1.f)) * edgeShare(u, v));
}

AreaLightSet::AreaLightSet(std::vector<AreaLight> lights) : lights_(std::move(lights)) {
    if (lights_.size() > mostLights)
        throw RunError("area light", fmt::format("there are {}", lights_.size()),
                       fmt::format("give at most {}", mostLights));
    for (AreaLight& light : lights_) {
        if (light.shape == AreaLight::Shape::disc)
            light.halfHeight = light.halfWidth;
        if (!(light.halfWidth > 0.f) || !(light.halfHeight > 0.f) || !std::isfinite(light.halfWidth + light.halfHeight))
            throw RunError("area light", "its sides must be above 0");
        if (!(std::min({light.radiance.x, light.radiance.y, light.radiance.z}) >= 0.f) ||
            !std::isfinite(light.radiance.x + light.radiance.y + light.radiance.z))
            throw RunError("area light", "its radiance is negative or not finite");
        if (!(light.softEdge >= 0.f && light.softEdge <= 1.f && light.dimming >= 0.f && light.dimming <= 1.f))
            throw RunError("area light", "its edge and dimming must be 0 to 1");
        power_ += double(luminance(light.radiance)) * double(light.area());
        beacons_.push_back({light.centre, light.frame.normal, meanLuminance(light) * light.area(),
                            std::max(light.halfWidth, light.halfHeight)});
    }
}

float AreaLightSet::weigh(const V3f& position, const V3f& normal, float* weights) const {
    float total = 0.f;
    for (std::size_t k = 0; k < beacons_.size(); ++k) {
        const Beacon& light = beacons_[k];
        const V3f towards = light.centre - position;
        // No nearer than its size: from close by, other parts of it than the middle are what is seen.
        const float inverse = 1.f / std::sqrt(std::max(towards.length2(), light.size * light.size));
        // Its middle may lie below the horizon while a part is above it.
        const float cosine = std::clamp((towards ^ normal) * inverse, 0.f, 1.f) + light.size * inverse * 0.5f;
        const float front = -(towards ^ light.normal); // its plane is the border of what sees it
        const float facing = std::clamp(front * inverse, 0.05f, 1.f);
        weights[k] = front > 0.f ? light.strength * cosine * facing * (inverse * inverse) : 0.f;
        total += weights[k];
    }
    return total;
}

AreaLightSet::Sample AreaLightSet::sample(const V3f& position, const V3f& normal, V2f random) const {
    std::array<float, mostLights> weights;
    const float total = weigh(position, normal, weights.data());
    if (!(total > 0.f))
        return {};
    float left = random.x * total;
    std::size_t chosen = lights_.size();
    for (std::size_t k = 0; k < lights_.size(); ++k) {
        const float mine = weights[k];
        if (!(mine > 0.f))
            continue;
        chosen = k;
        if (left < mine) {
            random.x = std::min(left / mine, 0.9999999f); // its place within the choice is as good as a new number
            break;
        }
        left -= mine;
    }
    const AreaLight& light = lights_[chosen];
    const V2f p = pointOn(light, random);
    const V3f towards = light.centre + light.frame.tangent * (p.x * light.halfWidth) +
                        light.frame.bitangent * (p.y * light.halfHeight) - position;
    Sample sample;
    sample.distance = std::sqrt(towards.length2());
    if (!(sample.distance > 0.f))
        return {};
    sample.direction = towards / sample.distance;
    const float cosine = -(sample.direction ^ light.frame.normal);
    if (!(cosine > 1e-6f))
        return {};
    sample.radiance = light.radianceAt(p.x, p.y);
    sample.pdf = weights[chosen] / total * sample.distance * sample.distance / (cosine * light.area()) *
                 (light.edgeShare(p.x, p.y) / light.meanEdgeShare());
    return sample;
}

std::optional<AreaLightSet::Sample> AreaLightSet::hit(std::size_t k, const V3f& position, const V3f& normal,
                                                      const V3f& direction, float farthest) const {
    const AreaLight& light = lights_[k];
    const float cosine = -(direction ^ light.frame.normal);
    if (!(cosine > 1e-6f))
        return {};
    Sample sample;
    sample.direction = direction;
    sample.distance = ((position - light.centre) ^ light.frame.normal) / cosine;
    if (!(sample.distance > 0.f && sample.distance < farthest))
        return {};
    const V3f place = position + direction * sample.distance - light.centre;
    const float u = (place ^ light.frame.tangent) / light.halfWidth;
    const float v = (place ^ light.frame.bitangent) / light.halfHeight;
    sample.radiance = light.radianceAt(u, v);
    if (luminance(sample.radiance) == 0.f)
        return {};
    std::array<float, mostLights> weights;
    const float total = weigh(position, normal, weights.data());
    sample.pdf = weights[k] / total * sample.distance * sample.distance / (cosine * light.area()) *
                 (light.edgeShare(u, v) / light.meanEdgeShare());
    return sample;
}

V3f AreaLightSet::irradiance(const V3f& position, const V3f& normal) const {
    constexpr int looks = 32;
    Imath::V3d sum(0.0);
    for (const AreaLight& light : lights_)
        for (int i = 0; i < looks * looks; ++i) {
            const V2f p = pointOn(light, {(float(i % looks) + 0.5f) / looks, (float(i / looks) + 0.5f) / looks});
            const float density = light.edgeShare(p.x, p.y) / light.meanEdgeShare();
            const V3f towards = light.centre + light.frame.tangent * (p.x * light.halfWidth) +
                                light.frame.bitangent * (p.y * light.halfHeight) - position;
            const float distance2 = towards.length2();
            const float cosines = std::max(0.f, towards ^ normal) * std::max(0.f, -(towards ^ light.frame.normal));
            if (cosines > 0.f)
                sum += Imath::V3d(light.radianceAt(p.x, p.y)) *
                       (double(cosines) * double(light.area()) /
                        (double(distance2) * distance2 * looks * looks * density));
        }
    return V3f(sum);
}

} // namespace patina
