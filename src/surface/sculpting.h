#pragma once
// Clay for the demo models: distance functions of simple bodies, negative inside, and smooth ways to join them
// (Quilez, "Distance functions" and "Smooth minimum", iquilezles.org). All lengths in the caller's unit.

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace patina::sculpting {

using Imath::V2d;
using Imath::V3d;

/// Distance to the surface, negative inside; exact or a little too small.
using Body = std::function<double(const V3d&)>;

inline double mix(double a, double b, double t) {
    return a + (b - a) * t;
}
inline V3d mix(const V3d& a, const V3d& b, double t) {
    return a + (b - a) * t;
}
inline double smoothstep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}
/// 1 at 0, falling to 0 at |x| = width.
inline double bump(double x, double width) {
    const double t = std::min(1.0, std::abs(x) / width);
    return (1.0 - t * t) * (1.0 - t * t);
}

/// Union whose seam is filled over about `k`.
inline double join(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k * 0.25;
}
/// `a` without `b`, the edge rounded over about `k`.
inline double carve(double a, double b, double k) {
    return -join(-a, b, k);
}

inline double sphere(const V3d& p, const V3d& centre, double radius) {
    return (p - centre).length() - radius;
}

/// First-order distance; good near the surface.
inline double ellipsoid(const V3d& p, const V3d& centre, const V3d& radii) {
    const V3d q = p - centre;
    const double k0 = V3d(q.x / radii.x, q.y / radii.y, q.z / radii.z).length();
    const double k1 = V3d(q.x / (radii.x * radii.x), q.y / (radii.y * radii.y), q.z / (radii.z * radii.z)).length();
    return k1 < 1e-12 ? -std::min({radii.x, radii.y, radii.z}) : k0 * (k0 - 1.0) / k1;
}

/// How far along the segment (0 to 1) the nearest point lies.
inline double alongSegment(const V3d& p, const V3d& a, const V3d& b) {
    const V3d ab = b - a;
    return std::clamp((p - a).dot(ab) / ab.dot(ab), 0.0, 1.0);
}

/// A limb: a capsule whose radius runs from ra at a to rb at b.
inline double limb(const V3d& p, const V3d& a, const V3d& b, double ra, double rb) {
    const double t = alongSegment(p, a, b);
    return (p - mix(a, b, t)).length() - mix(ra, rb, t);
}

/// A strand along a polyline, its radius given at each point.
struct Strand {
    std::vector<V3d> points;
    std::vector<double> radii;
    double distance(const V3d& p) const {
        double nearest = 1e30;
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
            nearest = std::min(nearest, limb(p, points[i], points[i + 1], radii[i], radii[i + 1]));
        return nearest;
    }
};

/// A row of cloth folds across `phase` (one fold per unit): round backs and narrow valleys, 0 in the valley to 1 on the
/// back.
inline double fold(double phase) {
    constexpr double valley = 0.28; // rounds the valley's bottom so that a few quads can hold it
    const double s = std::sin(M_PI * phase);
    return (std::sqrt(s * s + valley * valley) - valley) / (std::sqrt(1.0 + valley * valley) - valley);
}

/// The outermost point of the body on a ray from `origin`, or origin + direction * least where there is none
/// farther out than that. `farthest` must lie outside.
inline V3d outermost(const Body& body, const V3d& origin, const V3d& direction, double farthest, double least) {
    double t = farthest;
    double step = 0.0;
    for (int i = 0; i < 90 && t > least; ++i) {
        const double d = body(origin + direction * t);
        if (d < 0.0) { // stepped in: half-way back until on the surface
            double inside = t, outside = std::min(farthest, t + step);
            for (int k = 0; k < 12; ++k) {
                const double middle = 0.5 * (inside + outside);
                (body(origin + direction * middle) < 0.0 ? inside : outside) = middle;
            }
            t = inside;
            break;
        }
        if (d < 1e-3)
            break;
        step = std::max(0.75 * d, 0.02);
        t -= step;
    }
    return origin + direction * std::max(t, least);
}

} // namespace patina::sculpting
