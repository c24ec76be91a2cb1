#include "render/lights.h"

#include "base/errors.h"
#include "base/turns.h"

#include <algorithm>

namespace patina {

namespace {

constexpr float pi = float(M_PI);

float luminance(const Imath::V3f& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

bool usable(const Imath::V3f& c) {
    return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z) && c.x >= 0.f && c.y >= 0.f && c.z >= 0.f;
}

} // namespace

Imath::V3f KeyLight::radiance() const {
    const float s = std::sin(angularRadiusDegrees * pi / 180.f);
    return irradiance / (pi * s * s);
}

Lights::Lights(std::shared_ptr<const Environment> environment, std::optional<KeyLight> key, UpAxis up, bool skyOnly)
    : environment_(std::move(environment)), key_(key), frame_(uprightFrame(up)) {
    constexpr int rows = LightTables::rows, columns = LightTables::columns;
    double power = 0.0;
    std::vector<float> luminances;
    const int looks = environment_->looksPerCell(); // into each cell, each way
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            float sum = 0.f;
            for (int i = 0; i < looks * looks; ++i) {
                const Imath::V3f light = environment_->radiance(frame_.toWorld(LightTables::cellDirection(
                    row, column, (float(i / looks) + 0.5f) / looks, (float(i % looks) + 0.5f) / looks)));
                if (!usable(light))
                    throw RunError("environment", "its radiance is negative or not finite in some direction");
                sum += luminance(light);
            }
            luminances.push_back(sum / (looks * looks));
            power += luminances.back();
        }
    const double cells = double(luminances.size());
    // A cell seen dark keeps a hundredth of the mean, so that nothing bright between the looks is missed.
    const float least = power > 0.0 ? float(0.01 * power / cells) : 1.f;
    for (float& l : luminances)
        l = std::max(l, least);
    if (skyOnly || !environment_->isUniform())
        tables_ = LightTables(luminances, frame_, skyOnly);

    environmentPower_ = power / cells * M_PI;
    if (key_) {
        if (!(key_->angularRadiusDegrees >= 0.05f && key_->angularRadiusDegrees <= 60.f))
            throw RunError("key light", "its angular radius must be 0.05 to 60 degrees");
        if (!usable(key_->irradiance))
            throw RunError("key light", "its irradiance is negative or not finite");
        if (!(std::abs(key_->direction.length() - 1.f) < 1e-3f))
            throw RunError("key light", "its direction must be a unit vector");
        key_->direction.normalize();
        keyFrame_ = frameAround(key_->direction);
        keyRadiance_ = key_->radiance();
        const double half = std::sin(0.5 * double(key_->angularRadiusDegrees) * M_PI / 180.0);
        keyVersine_ = float(2.0 * half * half);
        // A facing surface sees the key light's irradiance and, of the environment, at most about a quarter of its
        // radiance summed over the sphere.
        const double keyPower = luminance(key_->irradiance);
        if (keyPower > 0.0)
            keyChance_ = float(std::clamp(keyPower / (keyPower + power / cells * M_PI), 0.1, 0.9));
        if (power == 0.0)
            keyChance_ = 1.f;
    }
}

void Lights::setAreaLights(AreaLightSet lights, float distance) {
    area_ = std::move(lights);
    const double others = environmentPower_ + (key_ ? luminance(key_->irradiance) : 0.f);
    double mine = 0.0; // what a surface facing each light gets, about
    for (const AreaLight& light : area_.lights())
        mine += double(luminance(light.radiance)) * double(light.area()) /
                std::max(double(light.area()), double(distance) * double(distance));
    areaChance_ = area_.empty() ? 0.f : others > 0.0 ? float(std::clamp(mine / (mine + others), 0.1, 0.9)) : 1.f;
}

Lights::Aim Lights::aim(const Imath::V3f& normal) const {
    return {tables_.empty() ? -1 : tables_.tableFor(normal), normal};
}

void Lights::aim(std::size_t count, const ConstVectors& normal, int* table) const {
    if (tables_.empty())
        std::fill_n(table, (count + 15) / 16 * 16, -1);
    else
        tables_.aim({count, normal, table});
}

void Lights::sampleEnvironment(const LightTables::SampleLanes& lanes, const Vectors& radiance) const {
    tables_.sample(lanes);
    environment_->radiance({lanes.count, {lanes.direction.x, lanes.direction.y, lanes.direction.z}, radiance});
}

Imath::V3f Lights::radiance(Source source, const Imath::V3f& direction) const {
    if (source == environment)
        return environment_->radiance(direction);
    // |d - k|² = 2 (1 - cos): exact for small angles, where a cosine in single precision is not.
    const bool inside = key_ && 0.5f * (direction - key_->direction).length2() <= keyVersine_;
    return inside ? keyRadiance_ : Imath::V3f(0.f);
}

Imath::V3f Lights::radiance(const Imath::V3f& direction) const {
    return radiance(environment, direction) + radiance(keyLight, direction);
}

float Lights::pdf(Source source, Aim aim, const Imath::V3f& direction) const {
    if (source == keyLight) {
        const bool inside = key_ && 0.5f * (direction - key_->direction).length2() <= keyVersine_;
        return inside ? 1.f / (2.f * pi * keyVersine_) : 0.f;
    }
    if (aim.table < 0)
        return std::max(aim.normal ^ direction, 0.f) / pi;
    return tables_.density(aim.table, direction);
}

Lights::Sample Lights::sample(Source source, Aim aim, const Imath::V2f& position) const {
    if (source == keyLight) {
        if (!key_)
            return {{0, 0, 1}, Imath::V3f(0.f), 0.f};
        // Uniform in the cone: 1 - cos is uniform.
        const float versine = keyVersine_ * position.x;
        const float r = std::sqrt(std::max(0.f, versine * (2.f - versine)));
        const CirclePoint around = circlePoint(position.y);
        const Imath::V3f direction = keyFrame_.toWorld({r * around.cosine, r * around.sine, 1.f - versine});
        return {direction, keyRadiance_, 1.f / (2.f * pi * keyVersine_)};
    }
    if (aim.table < 0) {
        // A point of the sphere that touches the surface from above, seen from where it touches, is as likely as the
        // cosine of its direction.
        const float z = 1.f - 2.f * position.x;
        const float r = std::sqrt(std::max(0.f, 1.f - z * z));
        const CirclePoint around = circlePoint(position.y);
        const Imath::V3f d = aim.normal + Imath::V3f(r * around.cosine, r * around.sine, z);
        const float length = std::sqrt(d.length2());
        if (!(length > 1e-4f))
            return {aim.normal, Imath::V3f(0.f), 0.f};
        const Imath::V3f direction = d / length;
        return {direction, environment_->radiance(direction), pdf(environment, aim, direction)};
    }
    const LightTables::Sample drawn = tables_.sample(aim.table, position);
    return {drawn.direction, environment_->radiance(drawn.direction), drawn.pdf};
}

Imath::V3f Lights::irradiance(const Imath::V3f& normal) const {
    constexpr int rows = LightTables::rows, columns = LightTables::columns;
    Imath::V3d sum(0.0);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const Imath::V3f direction = frame_.toWorld(LightTables::cellDirection(row, column, 0.5f, 0.5f));
            const float cosine = direction ^ normal;
            if (cosine > 0.f)
                sum += Imath::V3d(environment_->radiance(direction) * cosine);
        }
    sum *= 4.0 * M_PI / (double(rows) * columns);
    if (key_)
        sum += Imath::V3d(key_->irradiance * std::max(0.f, key_->direction ^ normal));
    return Imath::V3f(sum);
}

namespace {

// The lamp of both sets, as seen from the object.
constexpr float lampAzimuth = -34.f, lampElevation = 42.f, lampRadius = 5.f;
const Imath::V3f lampIrradiance(1.75f, 1.71f, 1.65f);

Imath::V3f towards(const Frame& set, float azimuthDegrees, float elevationDegrees) {
    const float azimuth = azimuthDegrees * pi / 180.f, elevation = elevationDegrees * pi / 180.f;
    return ((set.tangent * std::sin(azimuth) - set.bitangent * std::cos(azimuth)) * std::cos(elevation) +
            set.normal * std::sin(elevation))
        .normalized();
}

} // namespace

Lights studioLights(UpAxis up, float azimuthDegrees) {
    KeyLight key;
    key.direction = towards(uprightFrame(up, azimuthDegrees), lampAzimuth, lampElevation);
    key.angularRadiusDegrees = lampRadius;
    key.irradiance = lampIrradiance;
    return Lights(std::make_shared<StudioEnvironment>(up, azimuthDegrees), key, up, true);
}

Lights studioSet(UpAxis up, const Imath::Box3f& object, float azimuthDegrees) {
    const float radius = 0.5f * object.size().length();
    if (object.isEmpty() || !(radius > 0.f))
        throw RunError("studio", "there is no object to put lights around");
    constexpr float radii = 4.f;
    const Frame set = uprightFrame(up, azimuthDegrees);
    const float away = radii * radius;
    std::vector<AreaLight> lights;
    for (const StudioEnvironment::SoftBox& box : StudioEnvironment::softBoxes()) {
        AreaLight light;
        const Imath::V3f direction = towards(set, box.azimuthDegrees, box.elevationDegrees);
        light.centre = object.center() + direction * away;
        light.frame.normal = -direction;
        light.frame.tangent = set.normal.cross(towards(set, box.azimuthDegrees, 0.f));
        light.frame.bitangent = light.frame.normal.cross(light.frame.tangent);
        light.halfWidth = away * std::tan(box.halfWidthDegrees * pi / 180.f);
        light.halfHeight = away * std::tan(box.halfHeightDegrees * pi / 180.f);
        light.radiance = box.radiance;
        light.softEdge = 0.35f;
        light.dimming = 0.35f;
        lights.push_back(light);
    }
    AreaLight lamp;
    lamp.shape = AreaLight::Shape::disc;
    const Imath::V3f direction = towards(set, lampAzimuth, lampElevation);
    lamp.centre = object.center() + direction * away;
    lamp.frame = frameAround(-direction);
    // A disc of radius r at distance d irradiates what faces it by pi L r² / (r² + d²).
    lamp.halfWidth = away * std::tan(lampRadius * pi / 180.f);
    const float sine = std::sin(lampRadius * pi / 180.f);
    lamp.radiance = lampIrradiance / (pi * sine * sine);
    lights.push_back(lamp);
    Lights all(std::make_shared<StudioEnvironment>(up, azimuthDegrees, false), {}, up, true);
    all.setAreaLights(AreaLightSet(std::move(lights)), away);
    return all;
}

} // namespace patina
