#pragma once
// The statuette below the head as distance functions. Figure space: millimetres, x to the viewer's right, y to the back
// (the figure looks towards -y), z up from the seat.

#include "surface/sculpting.h"

namespace patina::statuette {

using namespace sculpting;

inline const V3d headCentre{0, -7, 155};
inline const V3d elbow{57, -2, 48};
inline const V3d cuff{28, -34, 42};

/// How far a point lies outside the robe's opening: a bowl from the neck over the chest down to the belly.
inline double outsideOpening(const V3d& p) {
    return join(ellipsoid(p, V3d(0, -38, 112), V3d(21, 40, 46)), limb(p, V3d(0, 3, 100), V3d(0, -3, 150), 15, 17), 5);
}

inline double neckBody(const V3d& p) {
    double d = limb(p, V3d(0, 5, 108), V3d(0, -1, 150), 14.5, 12.0);
    // Three creases, deeper in front.
    for (const double z : {124.0, 130.0, 136.0}) {
        const double crease = (p.z - z - 0.12 * (p.y + 10)) / 1.6;
        d += 0.8 * std::exp(-crease * crease) * smoothstep(8, -6, p.y);
    }
    return d;
}

/// Trunk and upper arms in the robe.
inline double torsoBody(const V3d& p) {
    const double ax = std::abs(p.x);
    const V3d q(ax, p.y, p.z);
    double trunk = join(ellipsoid(q, V3d(0, 4, 30), V3d(44, 31, 42)), ellipsoid(q, V3d(0, 4, 84), V3d(41, 26, 37)), 18);
    trunk = join(trunk, ellipsoid(q, V3d(0, 9, 8), V3d(50, 30, 26)), 14); // the robe spreads on the seat
    trunk = join(trunk, limb(q, V3d(8, 6, 121), V3d(42, 6, 102), 10, 14.5), 12);
    // Bare chest: two soft breasts.
    const double skin = join(trunk, ellipsoid(q, V3d(14, -13, 90), V3d(13, 8, 10)), 8);
    const double bareArm = limb(q, V3d(46, 6, 99), V3d(60, 3, 54), 14, 17);
    double arm = join(bareArm, limb(q, V3d(59, 5, 46), V3d(52, 9, 14), 16, 15), 10); // cloth from the elbow down

    const double outside = outsideOpening(p);
    arm = join(arm, limb(q, V3d(45, -3, 90), V3d(47, -6, 40), 12, 14), 8); // and between arm and chest
    double cloth = join(trunk, arm, mix(8, 18, smoothstep(0, 14, p.y)));   // no gap between arm and back
    if (cloth > 12.0)
        return cloth - 5.0;
    const double onArm = smoothstep(3, -3, bareArm - trunk);
    const double wave = std::sin(0.11 * p.x + 0.07 * p.z) + std::sin(0.05 * p.y - 0.09 * p.z + 0.04 * p.x);
    // On the trunk folds follow the opening; on the arms they hang across from shoulder to elbow.
    const double drape = 2.4 * fold((outside - 6.5) / 8.5 + 0.10 * wave) * smoothstep(5, 9, outside);
    const double back = 2.1 * fold((p.z + 0.55 * p.x + 0.006 * p.x * p.x) / 15 + 0.15 * wave);
    const double hang =
        mix(3.2, 2.0, smoothstep(0, 14, p.y)) * fold((p.z - 0.55 * p.y + 0.5 * (ax - 50)) / 12.5 + 0.16 * wave);
    const double relief = mix(mix(drape, back, smoothstep(0, 14, p.y)), hang, onArm);
    // Calm where cloth spans from one body to the other in front.
    const double spanning = smoothstep(1.0, 7.0, std::min(trunk, bareArm)) * smoothstep(6, -4, p.y);
    cloth -= 1.2 + relief * (1.0 - spanning);
    // The hem around the opening is turned over.
    cloth -= 1.3 * bump(outside - 2.6, 3.0);
    cloth = carve(cloth, 0.7 * outside, 0.8);
    return join(skin, cloth, 0.5);
}

/// A wide sleeve from the elbow to the wrist, its lower side hanging into the lap. Made for the figure's x > 0 side.
inline double sleeveBody(const V3d& p, double side) {
    const V3d axis = (cuff - elbow).normalized();
    const double arm = limb(p, elbow, cuff, 14.5, 10.5);
    const double hang = limb(p, V3d(57, -8, 34), V3d(38, -33, 30), 12, 6);
    double d = join(arm, hang, 12);
    if (d > 10.0)
        return d - 3.0;
    const double t = alongSegment(p, elbow, cuff);
    const double wave = std::sin(0.13 * p.z + 0.1 * p.x + side) + std::sin(0.09 * p.y + 0.05 * p.z);
    // Folds gather at the bend of the elbow and fan out.
    const double phase = 5.2 * t + 0.035 * (p.z - 40) + 0.12 * wave;
    d -= 2.0 * fold(phase) * smoothstep(1.05, 0.75, t) + 1.0 * bump(t - 0.96, 0.06);
    return carve(d, -(p - cuff).dot(axis) - 0.5 + 2.0, 1.5); // cut off square at the wrist
}

/// Crossed legs under the robe, its hem falling in pleats over the seat's edge in the middle.
inline double lapBody(const V3d& p) {
    const double ax = std::abs(p.x);
    const V3d q(ax, p.y, p.z);
    double d = limb(q, V3d(22, 8, 20), V3d(65, -20, 16), 24, 17.5);
    d = join(d, limb(q, V3d(64, -24, 15), V3d(4, -47, 12), 16.5, 13.0), 7);
    d = join(d, ellipsoid(q, V3d(0, -14, 6), V3d(72, 40, 22)), 10);
    if (d > 12.0)
        return d - 5.0;
    const double wave = std::sin(0.09 * p.x + 0.08 * p.y) + std::sin(0.06 * p.x - 0.11 * p.z + 1.0);
    // In front folds are drawn from the knees to the middle; on top they sweep in arcs around the hands.
    const double front = smoothstep(-18, -32, p.y - 0.2 * ax);
    const double fan = std::atan2(p.z - 1.0, 92.0 - ax) + 0.0035 * (p.z - 1.0);
    const double drawn = 2.4 * fold(fan / 0.17 + 0.15 * wave) * smoothstep(72, 46, ax);
    const double reach = std::hypot(0.62 * p.x, p.y + 18.0);
    const double arcs =
        2.0 * fold((reach - 20.0) / 8.5 + 0.12 * wave) * smoothstep(18, 26, reach) * smoothstep(66, 46, ax);
    d -= mix(arcs, drawn, front);
    // The pleated end of the robe.
    const double spread = 13.0 + 0.42 * (26.0 - p.z);
    double hem = ellipsoid(q, V3d(0, -52, 7), V3d(spread, 15, 24));
    hem -= 1.7 * fold(p.x / spread * 3.0 + 0.5) * smoothstep(30, 16, p.z);
    return join(d, hem, 1.5);
}

/// Hands laid in each other, palms up, fingers across, the hand from -x on top: its fingers rise to the back one behind
/// the other. Made for the wrist on the x > 0 side; `upper`: the hand on top.
struct Hand {
    bool upper;

    V3d knuckle(int finger) const { return V3d(9.5, -50 + 4.7 * finger, 37.0 + 1.9 * finger + (upper ? 5.0 : 0.0)); }

    /// Along a finger (0 the index finger) from the knuckle (0) to the tip (1).
    V3d fingerAt(int finger, double t) const {
        static constexpr double reach[] = {22, 25, 24, 20};
        const V3d start = knuckle(finger);
        if (t < 0.0)
            return mix(start, V3d(25, -37, 41.5), -t); // rooted in the palm
        // A gentle arch over the hand below.
        return start + V3d(-reach[finger] * t, 0.6 * t,
                           1.6 * std::sin(M_PI * std::min(1.0, 0.15 + 0.85 * t)) - 0.8 - 1.2 * t * t);
    }

    double finger(int finger, const V3d& p) const {
        double d = 1e9;
        const auto radius = [](double t) {
            return mix(3.0, 2.3, t) + 0.25 * bump(t - 0.42, 0.16) + 0.2 * bump(t - 0.72, 0.14);
        };
        for (int i = -1; i < 8; ++i)
            d = std::min(d, limb(p, fingerAt(finger, i / 8.0), fingerAt(finger, (i + 1) / 8.0), radius(i / 8.0),
                                 radius((i + 1) / 8.0)));
        return d;
    }

    /// Palm and wrist.
    double palm(const V3d& p) const {
        const V3d wrist(25, -37, 41.5);
        double d = limb(p, wrist, V3d(34, -27, 43), 6.2, 6.5);
        for (int i = 0; i < 4; ++i)
            d = join(d, limb(p, knuckle(i), wrist, 3.1, 5.2), 3.0);
        return join(d, limb(p, V3d(13, -45, 41), wrist, 4.0, 5.0), 3.0); // ball of the thumb
    }

    /// The thumb's middle line, from the ball (0) up to the tip (1), where both thumbs meet over the fingers.
    V3d thumbAt(double t) const {
        const V3d a(19, -43, 43.5), b(13, -51, 49), c(2.0, -50, 54);
        return a * ((1 - t) * (1 - t)) + b * (2 * t * (1 - t)) + c * (t * t);
    }

    double thumb(const V3d& p) const {
        double d = 1e9;
        const auto radius = [](double t) { return mix(3.9, 2.5, t) + 0.35 * bump(t - 0.55, 0.18); };
        for (int i = 0; i < 8; ++i)
            d = std::min(d, limb(p, thumbAt(i / 8.0), thumbAt((i + 1) / 8.0), radius(i / 8.0), radius((i + 1) / 8.0)));
        return d;
    }
};

} // namespace patina::statuette
