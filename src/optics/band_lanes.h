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

/// exp(-x) for x >= 0, to about 1e-7 relative; beyond exp(-87) it stays there.
/// -x = n ln 2 + r with |r| <= ln 2 / 2, a polynomial for exp(r) (Cephes' coefficients), and n added to the exponent.
template <int width>
PATINA_INLINE BandLanes<width> expOfMinus(const BandLanes<width>& x) {
    using Bits = typename Register<width>::Bits;
    const BandLanes<width> limit = BandLanes<width>::constant(87.f);
    const BandLanes<width> y = 0.f - whereGreater(x, 87.f, limit, x);
    // Adding 1.5 · 2^23 rounds to an integer and leaves it in the low bits.
    const BandLanes<width> shifted = y * 1.44269504088896341f + 12582912.f;
    const BandLanes<width> n = shifted - 12582912.f;
    const BandLanes<width> r = (y - n * 0.693359375f) + n * 2.12194440e-4f;
    BandLanes<width> p = r * 1.9875691500e-4f + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    p = (p * r) * r + r + 1.f;
    for (int i = 0; i < BandLanes<width>::registers; ++i) {
        Bits exponent, mantissa;
        std::memcpy(&exponent, &shifted.part[i], sizeof(exponent));
        std::memcpy(&mantissa, &p.part[i], sizeof(mantissa));
        const Bits sum = mantissa + (exponent << 23);
        std::memcpy(&p.part[i], &sum, sizeof(sum));
    }
    return p;
}

/// Sum over the bands of a · b: eights, then fours, then twos are added, in the same order for every width.
template <int width>
PATINA_INLINE float dotBands(const BandLanes<width>& a, const BandLanes<width>& b) {
    using Four = Register<4>::Floats;
    const BandLanes<width> product = a * b;
    Four fours[bandCount / 4];
    std::memcpy(fours, product.part, sizeof(fours));
    const Four four = (fours[0] + fours[2]) + (fours[1] + fours[3]);
    return (four[0] + four[2]) + (four[1] + four[3]);
}

} // namespace patina
