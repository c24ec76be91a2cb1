#include "operators/fields/wetness.h"

#include "operators/fields/drainage.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

double smoothstep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

} // namespace

LightDome rainDome() {
    LightDome dome;
    dome.addHemisphere([](const Imath::V3d& d) { return std::pow(d.z, 6.0); }, 1.0);
    return dome;
}

std::vector<float> wetness(const SurfaceVoxels& surface, const WetnessParts& parts, const WetnessOptions& options) {
    const Drainage drainage = drain(surface, options.up, parts.rain);
    std::vector<float> values(surface.size());
    tbb::parallel_for(std::size_t(0), surface.size(), [&](std::size_t i) {
        const double u = Imath::V3d(surface.normals[i]).dot(options.up);
        const double rain = parts.rain[i];
        const double passing = 1.0 - std::exp(-(drainage.passing[i] / options.height) / 0.06);
        const double supply = 1.0 - (1.0 - 0.15) * (1.0 - rain) * (1.0 - passing);

        double hold = u >= 0.0 ? 0.25 + 0.75 * smoothstep(0.0, 0.7, u) : 0.25 * (1.0 + u);
        hold = std::max(hold, double(drainage.retained[i]));
        const double crease = 1.0 - parts.accessibility[i];
        hold += (1.0 - hold) * 0.5 * crease * crease;

        const double drying = 1.0 - 0.45 * parts.exposure[i];
        const double above = (Imath::V3d(surface.feet[i]).dot(options.up) - options.lowest) / options.height;
        const double foot = 0.85 * std::exp(-std::max(0.0, above) / 0.05);
        values[i] = static_cast<float>(std::clamp(1.0 - (1.0 - supply * hold * drying) * (1.0 - foot), 0.0, 1.0));
    });
    return values;
}

} // namespace patina
