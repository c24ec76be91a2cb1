#pragma once
// How wide the grain of a layer is.

#include "volume/layer_volume.h"
#include "volume/stack_probe.h"

#include <cmath>
#include <vector>

namespace patina::test {

/// Distance (scene units) at which the autocorrelation of the only layer's thickness over a square sheet at z = 0 falls
/// to 1/e; a tenth of its side is left out along every edge. At most 0.4 of the side.
inline double correlationLength(const LayerVolume& volume, double side) {
    constexpr int n = 112;
    const StackProbe probe(volume);
    std::vector<double> field(n * n);
    const auto at = [&](int i) { return side * (0.1 + 0.8 * (i + 0.5) / n); };
    double mean = 0.0;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            probe.read({at(x), at(y), 0.0}, {0, 0, 1}, &field[std::size_t(y * n + x)]);
            mean += field[std::size_t(y * n + x)] / (n * n);
        }
    const auto covariance = [&](int shift) {
        double sum = 0.0;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x + shift < n; ++x) {
                sum += (field[std::size_t(y * n + x)] - mean) * (field[std::size_t(y * n + x + shift)] - mean);
                sum += (field[std::size_t(x * n + y)] - mean) * (field[std::size_t((x + shift) * n + y)] - mean);
            }
        return sum / (2.0 * n * (n - shift));
    };
    const double goal = covariance(0) * std::exp(-1.0);
    double last = covariance(0);
    for (int shift = 1; shift < n / 2; ++shift) {
        const double here = covariance(shift);
        if (here < goal)
            return 0.8 * side * (shift - 1 + (last - goal) / (last - here)) / n;
        last = here;
    }
    return 0.4 * side;
}

} // namespace patina::test
