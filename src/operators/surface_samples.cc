#include "operators/surface_samples.h"

#include <cmath>

namespace patina {

std::vector<SurfacePoint> evenSamples(const SurfaceMesh& surface, std::size_t count) {
    std::vector<double> upTo(surface.triangles.size() + 1, 0.0);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Imath::V3i& corners = surface.triangles[t];
        const Imath::V3d a(surface.positions[corners[0]]), b(surface.positions[corners[1]]),
            c(surface.positions[corners[2]]);
        upTo[t + 1] = upTo[t] + 0.5 * (b - a).cross(c - a).length();
    }
    std::vector<SurfacePoint> points;
    if (!(upTo.back() > 0.0))
        return points;
    points.reserve(count);
    // R2: multiples of 1/g and 1/g², g the plastic number; a point of the square beyond the diagonal is turned back.
    constexpr double g = 1.32471795724474602596;
    std::size_t t = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double target = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * upTo.back();
        while (t + 1 < surface.triangles.size() && upTo[t + 1] <= target)
            ++t;
        double u = std::fmod(0.5 + static_cast<double>(i + 1) / g, 1.0);
        double v = std::fmod(0.5 + static_cast<double>(i + 1) / (g * g), 1.0);
        if (u + v > 1.0) {
            u = 1.0 - u;
            v = 1.0 - v;
        }
        points.push_back({static_cast<int>(t), static_cast<float>(u), static_cast<float>(v)});
    }
    return points;
}

} // namespace patina
