#include "render/turntable.h"

#include <cmath>

namespace patina {

using Imath::V3f;

std::optional<Turntable::Hit> Turntable::intersect(const V3f& origin, const V3f& direction, float farthest) const {
    const V3f from = origin - middle_;
    const float height = from ^ up_, rising = direction ^ up_;
    // Its top, from above.
    if (height > 0.f && rising < -1e-7f) {
        const float distance = -height / rising;
        const V3f place = from + direction * distance;
        if (distance < farthest && (place - up_ * (place ^ up_)).length2() <= radius_ * radius_)
            return Hit{distance, up_};
    }
    // Its side: |aside + t sideways|² = r², the nearer root where it lies ahead, between top and bottom.
    const V3f aside = from - up_ * height, sideways = direction - up_ * rising;
    const double a = sideways.length2(), b = aside ^ sideways, c = double(aside.length2()) - double(radius_) * radius_;
    const double root = b * b - a * c;
    if (c <= 0.0 || b >= 0.0 || root <= 0.0 || a < 1e-14)
        return {};
    const auto distance = float(c / (-b + std::sqrt(root)));
    const float there = height + rising * distance;
    if (!(distance < farthest) || there > 0.f || there < -thickness_)
        return {};
    return Hit{distance, (aside + sideways * distance) / radius_};
}

} // namespace patina
