#pragma once
// All bands of a spectrum as vectors of the machine's width, for the inner loop of stack_kernel.cc only.
// Every band goes through the same IEEE operations in the same order whatever the width, so the bits are the same on
// machines with wide and with narrow registers.

#include "optics/rgb_lanes.h"
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

/// unit · exp(-x) = scale (1 - lost), where scale is unit · 2^n.
template <int width>
struct ScaledDecay {
    BandLanes<width> scale;
    BandLanes<width> lost;
};

/// For x >= 0; beyond exp(-60) it stays there: nothing that is left of it becomes a denormal number, which would cost a
/// hundred times as much. `unit` is a power of two.
/// x = t - n ln 2 with |t| <= ln 2 / 2 and n <= 0; lost = 1 - exp(-t) = t - t² p(t), p fitted to least error (2e-8 of
/// itself). One product n ln 2 is enough: what it rounds off is multiplied by 2^n.
template <int width>
PATINA_INLINE ScaledDecay<width> scaledDecay(const BandLanes<width>& x, float unit) {
    using Bits = typename Register<width>::Bits;
    constexpr float roundToInteger = 12582912.f; // 1.5 · 2^23: what is added to it leaves its integer in the low bits
    const BandLanes<width> y = atMost(x, 60.f);
    const BandLanes<width> shifted = roundToInteger - y * 1.44269504088896341f;
    const BandLanes<width> n = shifted - roundToInteger;
    const BandLanes<width> t = y + n * 0.693147180559945309f;
    const BandLanes<width> t2 = t * t;
    const BandLanes<width> high = (4.1666204126e-2f - t * 8.3689541340e-3f) + t2 * 1.3950603060e-3f;
    const BandLanes<width> p = (5.0000000957e-1f - t * 1.6666518301e-1f) + t2 * high;
    ScaledDecay<width> result;
    result.lost = t - t2 * p;
    std::uint32_t unitBits;
    std::memcpy(&unitBits, &unit, sizeof(unit));
    for (int i = 0; i < BandLanes<width>::registers; ++i) { // n is added to the exponent of `unit`
        Bits integer;
        std::memcpy(&integer, &shifted.part[i], sizeof(integer));
        const Bits scale = (integer << 23) + unitBits;
        std::memcpy(&result.scale.part[i], &scale, sizeof(scale));
    }
    return result;
}

/// exp(-x) alone.
template <int width>
PATINA_INLINE BandLanes<width> remaining(const BandLanes<width>& x) {
    const ScaledDecay<width> e = scaledDecay(x, 1.f);
    return e.scale - e.scale * e.lost;
}

/// (1 - exp(-x)) / 2. Where n = 0 it is lost / 2: there is no cancellation.
template <int width>
PATINA_INLINE BandLanes<width> halfGone(const BandLanes<width>& x) {
    const ScaledDecay<width> e = scaledDecay(x, 0.5f);
    return (0.5f - e.scale) + e.scale * e.lost;
}

template <int width>
PATINA_INLINE Decay<width> decay(const BandLanes<width>& x) {
    const ScaledDecay<width> e = scaledDecay(x, 1.f);
    const BandLanes<width> lost = e.scale * e.lost;
    return {e.scale - lost, (1.f - e.scale) + lost};
}

/// Element q of every four, four times.
template <int q>
PATINA_INLINE Register<4>::Floats repeated(const Register<4>::Floats& x) {
    return __builtin_shufflevector(x, x, q, q, q, q);
}
template <int q>
PATINA_INLINE Register<8>::Floats repeated(const Register<8>::Floats& x) {
    return __builtin_shufflevector(x, x, q, q, q, q, 4 + q, 4 + q, 4 + q, 4 + q);
}
template <int q>
PATINA_INLINE Register<16>::Floats repeated(const Register<16>::Floats& x) {
    return __builtin_shufflevector(x, x, q, q, q, q, 4 + q, 4 + q, 4 + q, 4 + q, 8 + q, 8 + q, 8 + q, 8 + q, 12 + q,
                                   12 + q, 12 + q, 12 + q);
}
template <int q, int width>
PATINA_INLINE BandLanes<width> weighted(const BandLanes<width>& bands, const ChannelWeights& weights) {
    BandLanes<width> result = BandLanes<width>::load(weights[q]);
    for (int i = 0; i < BandLanes<width>::registers; ++i) {
        result.part[i] = repeated<q>(bands.part[i]) * result.part[i];
    }
    return result;
}

/// The sums over the bands, in the same order for every width.
template <int width>
PATINA_INLINE RgbLanes toRgb(const BandLanes<width>& bands, const ChannelWeights& weights) {
    const BandLanes<width> sums = (weighted<0>(bands, weights) + weighted<1>(bands, weights)) +
                                  (weighted<2>(bands, weights) + weighted<3>(bands, weights));
    if constexpr (width == 4) {
        return (sums.part[0] + sums.part[2]) + (sums.part[1] + sums.part[3]);
    } else {
        Register<8>::Floats eight;
        if constexpr (width == 8) {
            eight = sums.part[0] + sums.part[1];
        } else {
            eight = __builtin_shufflevector(sums.part[0], sums.part[0], 0, 1, 2, 3, 4, 5, 6, 7) +
                    __builtin_shufflevector(sums.part[0], sums.part[0], 8, 9, 10, 11, 12, 13, 14, 15);
        }
        return __builtin_shufflevector(eight, eight, 0, 1, 2, 3) + __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
    }
}

} // namespace patina
