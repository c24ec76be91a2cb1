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

/// a b + c rounded once, in one register. The instruction is written out because the compiler's own function for it may
/// be called only from functions that are built for a machine, which templates cannot be.
PATINA_INLINE Register<4>::Floats fusedRegister(const Register<4>::Floats& a, const Register<4>::Floats& b,
                                                const Register<4>::Floats& c) {
#if defined(__x86_64__) && !defined(__FMA__)
    // The baseline has no such instruction. In double precision the product is exact; the sum is rounded to odd, which
    // makes the second rounding, to single precision, the right one (Boldo and Melquiond 2008).
    using Doubles = double __attribute__((vector_size(32)));
    using Longs = std::int64_t __attribute__((vector_size(32)));
    const Doubles product = __builtin_convertvector(a, Doubles) * __builtin_convertvector(b, Doubles);
    const Doubles addend = __builtin_convertvector(c, Doubles);
    const Doubles sum = product + addend;
    const Doubles part = sum - product;
    const Doubles error = (product - (sum - part)) + (addend - part);
    Longs bits;
    std::memcpy(&bits, &sum, sizeof(bits));
    const Longs away = (error > 0.0) == (sum > 0.0); // all ones where the true sum is further from 0 than `sum`
    const Longs step = (error != 0.0) & ((bits & 1) == 0) & ((away & 2) - 1);
    bits += step;
    Doubles odd;
    std::memcpy(&odd, &bits, sizeof(odd));
    return __builtin_convertvector(odd, Register<4>::Floats);
#else
    Register<4>::Floats result;
    for (int i = 0; i < 4; ++i) {
        result[i] = __builtin_fmaf(a[i], b[i], c[i]);
    }
    return result;
#endif
}
#if defined(__x86_64__)
PATINA_INLINE Register<8>::Floats fusedRegister(const Register<8>::Floats& a, const Register<8>::Floats& b,
                                                const Register<8>::Floats& c) {
    Register<8>::Floats result = a;
    __asm__("vfmadd213ps %2, %1, %0" : "+x"(result) : "x"(b), "x"(c));
    return result;
}
PATINA_INLINE Register<16>::Floats fusedRegister(const Register<16>::Floats& a, const Register<16>::Floats& b,
                                                 const Register<16>::Floats& c) {
    Register<16>::Floats result = a;
    __asm__("vfmadd213ps %2, %1, %0" : "+v"(result) : "v"(b), "v"(c));
    return result;
}
#endif

/// a b + c rounded once, band by band.
template <int width>
PATINA_INLINE BandLanes<width> fused(const BandLanes<width>& a, const BandLanes<width>& b, const BandLanes<width>& c) {
    BandLanes<width> result;
    for (int i = 0; i < BandLanes<width>::registers; ++i) {
        result.part[i] = fusedRegister(a.part[i], b.part[i], c.part[i]);
    }
    return result;
}
template <int width>
PATINA_INLINE BandLanes<width> fused(const BandLanes<width>& a, float b, const BandLanes<width>& c) {
    return fused(a, BandLanes<width>::constant(b), c);
}
template <int width>
PATINA_INLINE BandLanes<width> fused(const BandLanes<width>& a, float b, float c) {
    return fused(a, BandLanes<width>::constant(b), BandLanes<width>::constant(c));
}

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

/// unit · exp(-x) = scale (1 + change), where scale is unit · 2^n.
template <int width>
struct ScaledDecay {
    BandLanes<width> scale;
    BandLanes<width> change;
};

/// For x >= 0; beyond exp(-60) it stays there: nothing that is left of it becomes a denormal number, which would cost a
/// hundred times as much. `unit` is a power of two.
/// x = t - n ln 2 with |t| <= ln 2 / 2 and n <= 0; change = exp(-t) - 1 = t² p(t) - t, p fitted to least error (2e-8 of
/// itself). ln 2 in one number is enough: what it lacks is multiplied by 2^n.
template <int width>
PATINA_INLINE ScaledDecay<width> scaledDecay(const BandLanes<width>& x, float unit) {
    using Bits = typename Register<width>::Bits;
    constexpr float roundToInteger = 12582912.f; // 1.5 · 2^23: what is added to it leaves its integer in the low bits
    const BandLanes<width> y = atMost(x, 60.f);
    const BandLanes<width> shifted = fused(y, -1.44269504088896341f, roundToInteger);
    const BandLanes<width> n = shifted - roundToInteger;
    const BandLanes<width> t = fused(n, 0.693147180559945309f, y);
    const BandLanes<width> t2 = t * t;
    const BandLanes<width> high = fused(t2, 1.3950603060e-3f, fused(t, -8.3689541340e-3f, 4.1666204126e-2f));
    const BandLanes<width> p = fused(t2, high, fused(t, -1.6666518301e-1f, 5.0000000957e-1f));
    ScaledDecay<width> result;
    result.change = t2 * p - t;
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
    return fused(e.scale, e.change, e.scale);
}

/// (1 - exp(-x)) / 2. Where n = 0 it is -change / 2: there is no cancellation.
template <int width>
PATINA_INLINE BandLanes<width> halfGone(const BandLanes<width>& x) {
    const ScaledDecay<width> e = scaledDecay(x, 0.5f);
    return (0.5f - e.scale) - e.scale * e.change;
}

template <int width>
PATINA_INLINE Decay<width> decay(const BandLanes<width>& x) {
    const ScaledDecay<width> e = scaledDecay(x, 1.f);
    return {fused(e.scale, e.change, e.scale), (1.f - e.scale) - e.scale * e.change};
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
PATINA_INLINE BandLanes<width> repeated(const BandLanes<width>& bands) {
    BandLanes<width> result;
    for (int i = 0; i < BandLanes<width>::registers; ++i) {
        result.part[i] = repeated<q>(bands.part[i]);
    }
    return result;
}

/// The sums over the bands, in the same order for every width.
template <int width>
PATINA_INLINE RgbLanes toRgb(const BandLanes<width>& bands, const ChannelWeights& weights) {
    using Bands = BandLanes<width>;
    const Bands even = fused(repeated<0>(bands), Bands::load(weights[0]), repeated<2>(bands) * Bands::load(weights[2]));
    const Bands odd = fused(repeated<1>(bands), Bands::load(weights[1]), repeated<3>(bands) * Bands::load(weights[3]));
    const Bands sums = even + odd;
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
