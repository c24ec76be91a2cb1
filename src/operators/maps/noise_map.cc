#include "operators/maps/noise_map.h"

#include "base/errors.h"
#include "base/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace patina {

namespace {

double fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/// Towards one of the midpoints of the twelve edges of a cube (four of them twice), dotted with the offset.
double gradient(unsigned hash, double x, double y, double z) {
    static constexpr std::array<std::array<signed char, 3>, 16> directions = {{{1, 1, 0},
                                                                               {-1, 1, 0},
                                                                               {1, -1, 0},
                                                                               {-1, -1, 0},
                                                                               {1, 0, 1},
                                                                               {-1, 0, 1},
                                                                               {1, 0, -1},
                                                                               {-1, 0, -1},
                                                                               {0, 1, 1},
                                                                               {0, -1, 1},
                                                                               {0, 1, -1},
                                                                               {0, -1, -1},
                                                                               {1, 1, 0},
                                                                               {-1, 1, 0},
                                                                               {0, -1, 1},
                                                                               {0, -1, -1}}};
    const auto& d = directions[hash % 16];
    return d[0] * x + d[1] * y + d[2] * z;
}

double lerp(double t, double a, double b) {
    return a + t * (b - a);
}

void checkSize(double size) {
    if (!(size > 0.0) || !std::isfinite(size))
        throw RunError("noise", "the size of noise must be positive");
}

} // namespace

GradientNoise::GradientNoise(std::uint64_t seed, std::string_view label) {
    const KeyedRandom random(seed, label, "noise/permutation");
    std::iota(permutation_.begin(), permutation_.end(), std::uint16_t(0));
    for (std::size_t i = permutation_.size() - 1; i > 0; --i) { // Fisher and Yates
        const std::uint64_t word = random.words(static_cast<std::uint32_t>(i), 0, 0, 0)[0];
        std::swap(permutation_[i], permutation_[(word * (i + 1)) >> 32]);
    }
}

double GradientNoise::at(const Imath::V3d& p) const {
    constexpr unsigned mask = 4095;
    const Imath::V3d cell(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    const Imath::V3d f = p - cell;
    const auto index = [](double c) { return static_cast<unsigned>(static_cast<long long>(c)) & mask; };
    const unsigned x = index(cell.x), y = index(cell.y), z = index(cell.z);
    const auto corner = [&](unsigned i, unsigned j, unsigned k) {
        const unsigned hash =
            permutation_[(permutation_[(permutation_[(x + i) & mask] + y + j) & mask] + z + k) & mask];
        return gradient(hash, f.x - i, f.y - j, f.z - k);
    };
    const double u = fade(f.x), v = fade(f.y), w = fade(f.z);
    return lerp(w, lerp(v, lerp(u, corner(0, 0, 0), corner(1, 0, 0)), lerp(u, corner(0, 1, 0), corner(1, 1, 0))),
                lerp(v, lerp(u, corner(0, 0, 1), corner(1, 0, 1)), lerp(u, corner(0, 1, 1), corner(1, 1, 1))));
}

NoiseMap::NoiseMap(double size, std::uint64_t seed, std::string_view label) : noise_(seed, label), size_(size) {
    checkSize(size);
}

double NoiseMap::value(const MapPoint& point) const {
    return std::clamp(0.5 + 0.5 * noise_.at(point.position / size_), 0.0, 1.0);
}

TurbulenceMap::TurbulenceMap(double size, int octaves, std::uint64_t seed, std::string_view label)
    : noise_(seed, label), size_(size), octaves_(octaves) {
    checkSize(size);
    if (octaves < 1 || octaves > 16)
        throw RunError("turbulence", "octaves out of range", "use 1 to 16");
}

double TurbulenceMap::value(const MapPoint& point) const {
    Imath::V3d p = point.position / size_;
    double sum = 0.0, weight = 1.0, weights = 0.0;
    for (int i = 0; i < octaves_; ++i) {
        sum += weight * std::abs(noise_.at(p));
        weights += weight;
        weight *= 0.5;
        p *= 2.0;
    }
    return std::clamp(sum / weights, 0.0, 1.0);
}

} // namespace patina
