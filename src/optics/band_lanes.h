#pragma once
// All bands of a spectrum as vectors of the machine's width, for the inner loop of stack_kernel.cc only.
// Every band goes through the same IEEE operations in the same order whatever the width, so the bits are the same on
// machines with wide and with narrow registers.

#include "optics/spectrum.h"

#include <cstdint>
#include <cstring>

#define PATINA_INLINE inline __attribute__((always_inline))

namespace patina {

/// `width` single-precision numbers in one register.
template <int width>
struct Register;
template <>
struct Register<4> {
    using Floats = float __attribute__((vector_size(16)));
    using Bits = std::uint32_t __attribute__((vector_size(16)));
};
template <>
struct Register<8> {
    using Floats = float __attribute__((vector_size(32)));
    using Bits = std::uint32_t __attribute__((vector_size(32)));
};
template <>
struct Register<16> {
    using Floats = float __attribute__((vector_size(64)));
    using Bits = std::uint32_t __attribute__((vector_size(64)));
};

/// One number per band. Operators work band by band; a plain float stands for itself in every band.
template <int width>
struct BandLanes {
    static_assert(bandCount % width == 0, "bands must fill whole registers");
    static constexpr int registers = bandCount / width;
    using Floats = typename Register<width>::Floats;

    Floats part[registers];

    static PATINA_INLINE BandLanes constant(float value) {
        BandLanes result;
        for (int i = 0; i < registers; ++i) {
            result.part[i] = Floats{} + value;
        }
        return result;
    }
    static PATINA_INLINE BandLanes load(const Spectrum& spectrum) {
        BandLanes result;
        for (int i = 0; i < registers; ++i) { // one whole register at a time: a longer copy goes through narrow ones
            std::memcpy(&result.part[i], spectrum.values.data() + i * width, sizeof(Floats));
        }
        return result;
    }
    PATINA_INLINE void store(Spectrum& spectrum) const { std::memcpy(spectrum.values.data(), part, sizeof(part)); }
};

#define PATINA_BAND_OPERATOR(op)                                                                                       \
    template <int width>                                                                                               \
    PATINA_INLINE BandLanes<width> operator op(const BandLanes<width>& a, const BandLanes<width>& b) {                 \
        BandLanes<width> result;                                                                                       \
        for (int i = 0; i < BandLanes<width>::registers; ++i) {                                                        \
            result.part[i] = a.part[i] op b.part[i];                                                                   \
        }                                                                                                              \
        return result;                                                                                                 \
    }                                                                                                                  \
    template <int width>                                                                                               \
    PATINA_INLINE BandLanes<width> operator op(const BandLanes<width>& a, float b) {                                   \
        return a op BandLanes<width>::constant(b);                                                                     \
    }                                                                                                                  \
    template <int width>                                                                                               \
    PATINA_INLINE BandLanes<width> operator op(float a, const BandLanes<width>& b) {                                   \
        return BandLanes<width>::constant(a) op b;                                                                     \
    }
PATINA_BAND_OPERATOR(+)
PATINA_BAND_OPERATOR(-)
PATINA_BAND_OPERATOR(*)
PATINA_BAND_OPERATOR(/)
#undef PATINA_BAND_OPERATOR

/// In every band: `above` where x > threshold, `otherwise` elsewhere.
template <int width>
PATINA_INLINE BandLanes<width> whereGreater(const BandLanes<width>& x, float threshold, const BandLanes<width>& above,
                                            const BandLanes<width>& otherwise) {
    BandLanes<width> result;
    for (int i = 0; i < BandLanes<width>::registers; ++i) {
        result.part[i] = x.part[i] > threshold ? above.part[i] : otherwise.part[i];
    }
    return result;
}

/// The smaller of x and a limit, band by band.
template <int width>
PATINA_INLINE BandLanes<width> atMost(const BandLanes<width>& x, float limit) {
    return whereGreater(x, limit, BandLanes<width>::constant(limit), x);
}

/// exp(-x) and 1 - exp(-x), each to about 1e-7 of itself.
template <int width>
struct Decay {
    BandLanes<width> left;
    BandLanes<width> gone;
};

/// For x >= 0; beyond exp(-60) it stays there: nothing that is left of it becomes a denormal number, which would cost a
/// hundred times as much.
/// -x = n ln 2 + r with |r| <= ln 2 / 2, a polynomial for exp(r) - 1 (Cephes' coefficients), and n added to the
/// exponent of exp(r). Where n = 0 the polynomial is 1 - exp(-x) without the cancellation.
template <int width>
PATINA_INLINE Decay<width> decay(const BandLanes<width>& x) {
    using Bits = typename Register<width>::Bits;
    constexpr float roundToInteger = 12582912.f; // 1.5 · 2^23: what is added to it leaves its integer in the low bits
    const BandLanes<width> y = atMost(x, 60.f);
    const BandLanes<width> shifted = roundToInteger - y * 1.44269504088896341f;
    const BandLanes<width> n = shifted - roundToInteger;
    const BandLanes<width> r = n * 2.12194440e-4f - (y + n * 0.693359375f);
    BandLanes<width> p = r * 1.9875691500e-4f + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    const BandLanes<width> grown = (p * r) * r + r; // exp(r) - 1
    Decay<width> result;
    result.left = grown + 1.f;
    for (int i = 0; i < BandLanes<width>::registers; ++i) {
        Bits exponent, mantissa;
        std::memcpy(&exponent, &shifted.part[i], sizeof(exponent));
        std::memcpy(&mantissa, &result.left.part[i], sizeof(mantissa));
        const Bits sum = mantissa + (exponent << 23);
        std::memcpy(&result.left.part[i], &sum, sizeof(sum));
    }
    // n > -1/2: no halving took place.
    result.gone = whereGreater(n, -0.5f, 0.f - grown, 1.f - result.left);
    return result;
}

/// Sum over the bands of a · b and of two more, into rgb[0 … 2]: eights, then fours, then twos are added, in the same
/// order for every width.
template <int width>
PATINA_INLINE void dotBands(const BandLanes<width>& a, const Spectrum* weights, float* rgb) {
    using Four = Register<4>::Floats;
    using Eight = Register<8>::Floats;
    Four fours[3];
    for (int channel = 0; channel < 3; ++channel) {
        const BandLanes<width> product = a * BandLanes<width>::load(weights[channel]);
        if constexpr (width == 4) {
            fours[channel] = (product.part[0] + product.part[2]) + (product.part[1] + product.part[3]);
        } else {
            Eight eights;
            if constexpr (width == 8) {
                eights = product.part[0] + product.part[1];
            } else {
                eights = __builtin_shufflevector(product.part[0], product.part[0], 0, 1, 2, 3, 4, 5, 6, 7) +
                         __builtin_shufflevector(product.part[0], product.part[0], 8, 9, 10, 11, 12, 13, 14, 15);
            }
            fours[channel] = __builtin_shufflevector(eights, eights, 0, 1, 2, 3) +
                             __builtin_shufflevector(eights, eights, 4, 5, 6, 7);
        }
    }
    const Four twos01 = __builtin_shufflevector(fours[0], fours[1], 0, 4, 1, 5) +
                        __builtin_shufflevector(fours[0], fours[1], 2, 6, 3, 7);
    const Four twos2 = __builtin_shufflevector(fours[2], fours[2], 0, 0, 1, 1) +
                       __builtin_shufflevector(fours[2], fours[2], 2, 2, 3, 3);
    const Four sum =
        __builtin_shufflevector(twos01, twos2, 0, 1, 4, 5) + __builtin_shufflevector(twos01, twos2, 2, 3, 6, 7);
    std::memcpy(rgb, &sum, 3 * sizeof(float));
}

} // namespace patina
