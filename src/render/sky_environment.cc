#include "render/sky_environment.h"

#include "base/errors.h"
#include "operators/fields/sun_and_sky.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr float pi = float(M_PI);
constexpr float groundAlbedo = 0.2f;

class SkyEnvironment final : public Environment {
  public:
    SkyEnvironment(int type, const Imath::V3f& sun, UpAxis up, float horizontalIrradiance, float ground)
        : type_(type), set_(uprightFrame(up)), sun_(set_.toLocal(sun)), ground_(ground) {
        // Horizontal irradiance of L / Lz by the midpoint rule in sin² of the altitude, which is the cosine's measure.
        double sum = 0.0;
        constexpr int rows = 64, columns = 128;
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) {
                const double z = std::sqrt((i + 0.5) / rows), r = std::sqrt(1.0 - z * z),
                             phi = 2.0 * M_PI * (j + 0.5) / columns;
                sum += cieSkyRadiance(type_, {r * std::cos(phi), r * std::sin(phi), z}, Imath::V3d(sun_));
            }
        scale_ = float(horizontalIrradiance / (M_PI * sum / (rows * columns)));
    }
    using Environment::radiance;
    Imath::V3f radiance(const Imath::V3f& direction) const override {
        Imath::V3d d(set_.toLocal(direction));
        if (d.z < 0.0)
            return Imath::V3f(ground_);
        d.z = std::max(d.z, 1e-3); // the formula ends at the horizon
        return Imath::V3f(scale_ * float(cieSkyRadiance(type_, d.normalized(), Imath::V3d(sun_))));
    }

  private:
    int type_;
    Frame set_;
    Imath::V3f sun_;
    float ground_, scale_ = 1.f;
};

} // namespace

Lights daylight(const Daylight& light, UpAxis up) {
    if (light.sky < 1 || light.sky > 16)
        throw RunError("sky", "its type must be 1 to 16", "12 is clear, 16 overcast (CIE S 011)");
    if (!(light.sunAltitudeDegrees >= -5.f && light.sunAltitudeDegrees <= 90.f) ||
        !std::isfinite(light.sunAzimuthDegrees))
        throw RunError("sky", "the sun's altitude must be -5 to 90 degrees, its azimuth a number");
    if (!(light.skyShare > 0.f && light.skyShare <= 1.f))
        throw RunError("sky", "its share of the light must be above 0 and at most 1");
    const Frame set = uprightFrame(up);
    const float azimuth = light.sunAzimuthDegrees * pi / 180.f, altitude = light.sunAltitudeDegrees * pi / 180.f;
    const Imath::V3f sun = ((set.tangent * std::sin(azimuth) - set.bitangent * std::cos(azimuth)) * std::cos(altitude) +
                            set.normal * std::sin(altitude))
                               .normalized();
    const bool shines = light.sun && light.sunAltitudeDegrees > 0.f;
    const float skyIrradiance = shines ? pi * light.skyShare : pi;
    std::optional<KeyLight> key;
    if (shines) {
        key.emplace();
        key->direction = sun;
        key->angularRadiusDegrees = 0.27f;
        // What the horizontal is to receive, at most what six times as much straight on gives it when the sun is low.
        key->irradiance = Imath::V3f((pi - skyIrradiance) / std::max(std::sin(altitude), 1.f / 6.f));
    }
    return Lights(std::make_shared<SkyEnvironment>(light.sky, sun, up, skyIrradiance, groundAlbedo), key, up);
}

} // namespace patina
