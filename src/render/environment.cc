#include "render/environment.h"

#include <algorithm>

namespace patina {

void Environment::radiance(const RadianceLanes& lanes) const {
    for (std::size_t i = 0; i < lanes.count; ++i) {
        const Imath::V3f light = radiance({lanes.direction.x[i], lanes.direction.y[i], lanes.direction.z[i]});
        lanes.radiance.x[i] = light.x;
        lanes.radiance.y[i] = light.y;
        lanes.radiance.z[i] = light.z;
    }
}

void UniformEnvironment::radiance(const RadianceLanes& lanes) const {
    std::fill_n(lanes.radiance.x, lanes.count, radiance_.x);
    std::fill_n(lanes.radiance.y, lanes.count, radiance_.y);
    std::fill_n(lanes.radiance.z, lanes.count, radiance_.z);
}

namespace {

float smoothStep(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.f, 1.f);
    return t * t * (3.f - 2.f * t);
}

Imath::V3f mix(const Imath::V3f& a, const Imath::V3f& b, float t) {
    return a * (1.f - t) + b * t;
}

// The set, in units in which a white card on the floor is about 1: a broad main box to the left, a weaker one filling
// from the right, a strip behind on each side for the outline, and a lid.
const std::vector<StudioEnvironment::SoftBox> studioBoxes = {
    {-58.f, 30.f, 20.f, 34.f, {2.9f, 2.86f, 2.8f}}, {62.f, 20.f, 10.f, 30.f, {1.4f, 1.43f, 1.48f}},
    {-150.f, 26.f, 9.f, 34.f, {2.9f, 2.9f, 2.9f}},  {138.f, 28.f, 9.f, 34.f, {3.2f, 3.24f, 3.3f}},
    {180.f, 76.f, 24.f, 16.f, {1.4f, 1.4f, 1.4f}},
};

} // namespace

const std::vector<StudioEnvironment::SoftBox>& StudioEnvironment::softBoxes() {
    return studioBoxes;
}

StudioEnvironment::StudioEnvironment(UpAxis up, float azimuthDegrees, bool boxes)
    : set_(uprightFrame(up, azimuthDegrees)) {
    if (!boxes)
        return;
    constexpr float radians = float(M_PI) / 180.f;
    for (const SoftBox& box : studioBoxes) {
        const float azimuth = box.azimuthDegrees * radians, elevation = box.elevationDegrees * radians;
        const Imath::V3f aside = set_.tangent * std::sin(azimuth) - set_.bitangent * std::cos(azimuth);
        const Imath::V3f centre = aside * std::cos(elevation) + set_.normal * std::sin(elevation);
        const Imath::V3f across = set_.normal.cross(aside);
        boxes_.push_back({{across, centre.cross(across), centre},
                          std::tan(box.halfWidthDegrees * radians),
                          std::tan(box.halfHeightDegrees * radians),
                          box.radiance});
    }
}

Imath::V3f StudioEnvironment::radiance(const Imath::V3f& direction) const {
    static const Imath::V3f zenith(0.10f, 0.106f, 0.115f), horizon(0.25f, 0.25f, 0.25f);
    static const Imath::V3f edge(0.18f, 0.177f, 0.174f), nadir(0.10f, 0.098f, 0.096f);
    const float height = direction ^ set_.normal;
    Imath::V3f light = height >= 0.f ? mix(horizon, zenith, std::sqrt(std::min(height, 1.f)))
                                     : mix(edge, nadir, std::min(-height, 1.f));
    light = mix(light, horizon, 1.f - smoothStep(0.f, 0.04f, std::abs(height)));
    for (const Box& box : boxes_) {
        const float facing = direction ^ box.frame.normal;
        if (facing <= 0.05f)
            continue;
        const float u = std::abs((direction ^ box.frame.tangent) / (facing * box.halfWidth));
        const float v = std::abs((direction ^ box.frame.bitangent) / (facing * box.halfHeight));
        if (u >= 1.f || v >= 1.f)
            continue;
        // Brightest in the middle, as a lamp behind cloth is; the cloth's edge is a third of it wide.
        const float edges = (1.f - smoothStep(0.65f, 1.f, u)) * (1.f - smoothStep(0.65f, 1.f, v));
        const float lamp = 1.f - 0.35f * std::min(u * u + v * v, 1.f);
        light = mix(light, box.radiance * lamp, edges);
    }
    return light;
}

} // namespace patina
