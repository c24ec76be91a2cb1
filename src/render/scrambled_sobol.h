#pragma once
// Points of the Sobol' sequence under Owen's scrambling (Burley, Practical Hash-based Owen Scrambling, 2020), one or
// many lanes at a time.

#include "base/lane_kernel.h"

#include <cstdint>

namespace patina {

PATINA_LANE_BODY std::uint32_t reverseBits(std::uint32_t v) {
    v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    v = ((v >> 4) & 0x0F0F0F0Fu) | ((v & 0x0F0F0F0Fu) << 4);
    v = ((v >> 8) & 0x00FF00FFu) | ((v & 0x00FF00FFu) << 8);
    return (v >> 16) | (v << 16);
}

/// Multiplying by an even number lets each bit flip only bits above it. On reversed bits that is Owen's scrambling: a
/// digit is flipped depending on the more significant ones alone. The constants are those of Burley's paper.
PATINA_LANE_BODY std::uint32_t scrambleReversed(std::uint32_t v, std::uint32_t seed) {
    v += seed;
    v ^= v * 0x6c50b47cu;
    v ^= v * 0xb82f1e52u;
    v ^= v * 0xc7afe638u;
    v ^= v * 0x8d22f6e6u;
    return v;
}

/// Second dimension of the Sobol' sequence, with the first digit as the lowest bit. Its matrix is Pascal's triangle
/// modulo 2: digit r is the sum of the index's bits c of which r is a subset, so it is summed one bit of c at a time.
PATINA_LANE_BODY std::uint32_t sobolSecondReversed(std::uint32_t index) {
    index ^= (index & 0xAAAAAAAAu) >> 1;
    index ^= (index & 0xCCCCCCCCu) >> 2;
    index ^= (index & 0xF0F0F0F0u) >> 4;
    index ^= (index & 0xFF00FF00u) >> 8;
    index ^= index >> 16;
    return index;
}

/// 0 up to but not 1, from the upper 24 bits.
PATINA_LANE_BODY float unitOf(std::uint32_t word) {
    return float(std::int32_t(word >> 8)) * (1.f / 16777216.f); // signed: that is what processors convert
}

/// Point number `sample`; the seeds shuffle the order and scramble the two dimensions.
PATINA_LANE_BODY void scrambledSobol(std::uint32_t sample, std::uint32_t order, std::uint32_t scrambleU,
                                     std::uint32_t scrambleV, float& u, float& v) {
    const std::uint32_t index = reverseBits(scrambleReversed(reverseBits(sample), order));
    // The first dimension is the index with its bits reversed; scrambling wants it reversed once more.
    u = unitOf(reverseBits(scrambleReversed(index, scrambleU)));
    v = unitOf(reverseBits(scrambleReversed(sobolSecondReversed(index), scrambleV)));
}

} // namespace patina
