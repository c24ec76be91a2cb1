#pragma once
// Round numbers for the ticks of an axis.

#include <cmath>

namespace patina {

/// The smallest of 1, 2 or 5 times a power of ten that divides `most` (> 0) into at most about `count` (> 0) steps.
inline double axisStep(double most, int count) {
    const double raw = most / count, power = std::pow(10.0, std::floor(std::log10(raw)));
    for (const double m : {1.0, 2.0, 5.0})
        if (m * power >= raw * (1.0 - 1e-9))
            return m * power;
    return 10.0 * power;
}

} // namespace patina
