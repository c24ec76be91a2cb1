#pragma once
// Angles in turns (1: all the way round), by polynomials in single precision: several times as fast as the standard
// library's functions, and the same bits on every machine, whose libraries choose their own instructions.
// Coefficients: our own minimax fits (Lawson's iteration).

#include <algorithm>
#include <cmath>

namespace patina {

struct CirclePoint {
    float cosine;
    float sine;
};

/// Of an angle of up to some thousand turns. Off by 2e-7 at most.
inline CirclePoint circlePoint(float turn) {
    // The nearest quarter, and what is left: at most an eighth.
    const int quarter = static_cast<int>(4.f * turn + (turn < 0.f ? -0.5f : 0.5f));
    const float t = turn - 0.25f * static_cast<float>(quarter), t2 = t * t;
    const float s = t * (6.28318522f + t2 * (-41.341628f + t2 * (81.5881246f - 75.2400606f * t2)));
    const float c = 1.f + t2 * (-19.7392087f + t2 * (64.9393265f + t2 * (-85.4437417f + 59.245962f * t2)));
    const bool odd = (quarter & 1) != 0;
    const float x = odd ? s : c, y = odd ? c : s;
    return {((quarter + 1) & 2) != 0 ? -x : x, (quarter & 2) != 0 ? -y : y};
}

/// The angle of (x, y) from the x axis, -0.5…0.5; 0 for (0, 0). Off by 1e-7 at most.
inline float turnOf(float x, float y) {
    const float ax = std::abs(x), ay = std::abs(y);
    const float most = std::max(ax, ay), ratio = most > 0.f ? std::min(ax, ay) / most : 0.f, r2 = ratio * ratio;
    float turn =
        ratio * (0.159154324f +
                 r2 * (-0.0530262381f +
                       r2 * (0.0315251166f +
                             r2 * (-0.0210615141f +
                                   r2 * (0.0126724936f + r2 * (-0.00534827117f + 0.00108412833f * r2))))));
    turn = ay > ax ? 0.25f - turn : turn;
    turn = x < 0.f ? 0.5f - turn : turn;
    return y < 0.f ? -turn : turn;
}

/// The angle whose cosine this is (clamped to -1…1), over half a turn: 0 for 1, 1 for -1. Off by 1e-7 at most.
inline float halfTurnsOfCosine(float cosine) {
    const float x = std::min(std::abs(cosine), 1.f);
    const float angle =
        std::sqrt(1.f - x) *
        (0.499999972f +
         x * (-0.0683064651f +
              x * (0.0282773414f +
                   x * (-0.0156600334f + x * (0.00883721517f + x * (-0.00382080407f + 0.00083133809f * x))))));
    return cosine < 0.f ? 1.f - angle : angle;
}

} // namespace patina
