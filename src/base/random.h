#pragma once
// Counter-based random numbers (Philox 4x32-10, Random123): a number is a pure function of its key and counter, so
// results depend neither on the order of evaluation nor on the number of threads.

#include <array>
#include <cstdint>
#include <string_view>

namespace patina {

/// A stream of random numbers named by a seed and by words (a layer's label, a model's name …).
/// The key is a 64-bit hash of all of them; the counter is an event number and a lattice coordinate.
class KeyedRandom {
  public:
    KeyedRandom(std::uint64_t seed, std::string_view label, std::string_view purpose);

    /// Four independent 32-bit words for the event at lattice coordinate (x, y, z).
    std::array<std::uint32_t, 4> words(std::uint32_t event, std::int32_t x, std::int32_t y, std::int32_t z) const;

    /// Four independent uniforms in the open interval (0, 1).
    std::array<double, 4> uniforms(std::uint32_t event, std::int32_t x, std::int32_t y, std::int32_t z) const;

  private:
    std::array<std::uint32_t, 2> key_;
};

/// A 32-bit word as a uniform in the open interval (0, 1).
inline double uniformFromWord(std::uint32_t word) {
    return (word + 0.5) * (1.0 / 4294967296.0);
}

} // namespace patina
