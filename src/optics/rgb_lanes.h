#pragma once
// Three channels in one register of the baseline's width.

#include "optics/spectrum.h"

#include <Imath/ImathVec.h>

#include <array>
#include <cstring>

namespace patina {

/// Red, green, blue, and a fourth that nothing reads.
using RgbLanes = float __attribute__((vector_size(16)));

/// Weights of the bands in the three channels, so arranged that no band has to cross a quarter of a register: entry
/// 4 i + channel of weights[q] is for band 4 i + q; the fourth of each four is 0.
using ChannelWeights = std::array<Spectrum, 4>;

/// The same number in all channels.
inline RgbLanes rgbOf(float value) {
    return RgbLanes{} + value;
}

inline RgbLanes lower(RgbLanes a, RgbLanes b) {
    return a < b ? a : b;
}
inline RgbLanes higher(RgbLanes a, RgbLanes b) {
    return a > b ? a : b;
}

inline void store(RgbLanes rgb, Imath::V3f& to) {
    std::memcpy(&to.x, &rgb, 2 * sizeof(float));
    to.z = rgb[2];
}

} // namespace patina
