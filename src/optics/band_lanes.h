#pragma once
// All bands of a spectrum as one vector, for the inner loop of layer_stack.cc only.
// The compiler splits it into what the machine has (four SSE, two AVX or one AVX-512 register); every lane goes through
// the same IEEE operations in the same order, so the bits are the same on all of them.

#include "optics/spectrum.h"

#include <cstdint>
#include <cstring>

#define PATINA_INLINE inline __attribute__((always_inline))

namespace patina {

static_assert(bandCount == 16, "the vector below holds one number per band");
using BandLanes = float __attribute__((vector_size(64)));
using BandBits = std::uint32_t __attribute__((vector_size(64)));

PATINA_INLINE void loadBands(const Spectrum& spectrum, BandLanes& out) {
    std::memcpy(&out, spectrum.values.data(), sizeof(out));
}

/// exp(x) for x <= 0, to about 1e-7 relative; below exp(-87) it stays there.
/// x = n ln 2 + r with |r| <= ln 2 / 2, a polynomial for exp(r) (Cephes' coefficients), and n added to the exponent.
PATINA_INLINE void expBands(const BandLanes& x, BandLanes& out) {
    const BandLanes lowest = BandLanes{} - 87.f;
    const BandLanes clamped = x > lowest ? x : lowest;
    // Adding 1.5 · 2^23 rounds to an integer and leaves it in the low bits.
    const BandLanes shifted = clamped * 1.44269504088896341f + 12582912.f;
    const BandLanes n = shifted - 12582912.f;
    const BandLanes r = (clamped - n * 0.693359375f) + n * 2.12194440e-4f;
    BandLanes p = r * 1.9875691500e-4f + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    p = (p * r) * r + r + 1.f;
    BandBits bits;
    std::memcpy(&bits, &shifted, sizeof(bits));
    BandBits mantissa;
    std::memcpy(&mantissa, &p, sizeof(mantissa));
    const BandBits result = mantissa + (bits << 23);
    std::memcpy(&out, &result, sizeof(out));
}

/// Sum over the bands of a · b, always in the same order.
PATINA_INLINE float dotBands(const BandLanes& a, const BandLanes& b) {
    using Half = float __attribute__((vector_size(32)));
    using Quarter = float __attribute__((vector_size(16)));
    const BandLanes product = a * b;
    Half halves[2];
    std::memcpy(halves, &product, sizeof(product));
    const Half half = halves[0] + halves[1];
    Quarter quarters[2];
    std::memcpy(quarters, &half, sizeof(half));
    const Quarter quarter = quarters[0] + quarters[1];
    return (quarter[0] + quarter[2]) + (quarter[1] + quarter[3]);
}

} // namespace patina
