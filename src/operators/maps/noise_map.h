#pragma once
// Noise and turbulence in model space (paper section 3.3 and its reference [6]).

#include "operators/maps/thickness_map.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace patina {

/// Perlin's improved gradient noise: a band-limited random field, 0 on the integer lattice, within -1…1, two continuous
/// derivatives. (K. Perlin, "An image synthesizer", SIGGRAPH 1985; "Improving noise", SIGGRAPH 2002.)
/// The field repeats every 4096 units.
class GradientNoise {
  public:
    /// A field of its own for each seed and label.
    GradientNoise(std::uint64_t seed, std::string_view label);
    double at(const Imath::V3d& p) const;

  private:
    std::array<std::uint16_t, 4096> permutation_;
};

/// noise(size): 0.5 + 0.5 noise(p / size), clamped to 0…1; mean 0.5.
class NoiseMap : public ThicknessMap {
  public:
    /// \param size of the features (one period of the lattice), scene units. \throws RunError when it is not positive.
    NoiseMap(double size, std::uint64_t seed, std::string_view label);
    double value(const MapPoint& point) const override;

  private:
    GradientNoise noise_;
    double size_;
};

/// turbulence(size, octaves): the sum of |noise(2^i p / size)| / 2^i over the octaves, divided by the sum of 1 / 2^i,
/// so within 0…1; dark veins where the noise is 0, mean about 0.2.
class TurbulenceMap : public ThicknessMap {
  public:
    /// \param octaves 1…16. \throws RunError when out of range or size is not positive.
    TurbulenceMap(double size, int octaves, std::uint64_t seed, std::string_view label);
    double value(const MapPoint& point) const override;

  private:
    GradientNoise noise_;
    double size_;
    int octaves_;
};

} // namespace patina
