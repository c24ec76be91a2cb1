#pragma once
// Loops over lanes, compiled for each width of the processor's registers and chosen when the program runs. Every width
// gives the same bits: no operation is contracted or approximated, and lanes do not meet.

namespace patina {

/// Lanes of a register of this processor that kernels may use: 16, 8 or 4.
inline int laneWidth() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const int width = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                                     __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")
                                 ? 16
                             : __builtin_cpu_supports("avx2") ? 8
                                                              : 4;
    return width;
#else
    return 4;
#endif
}

} // namespace patina

/// Defines `void name(const Arguments&)` from `void nameBody(const Arguments&)`, an always inlined function whose loop
/// has neither calls nor ways out, so that the compiler can take many lanes at once. PATINA_LANES before a loop says
/// that no array it writes overlaps another.
#if defined(__x86_64__) && defined(__GNUC__)
#define PATINA_LANE_BODY [[gnu::always_inline]] inline
#define PATINA_LANES _Pragma("GCC ivdep")
#define PATINA_LANE_KERNEL(name, Arguments)                                                                            \
    [[gnu::target("avx512f,avx512bw,avx512dq,avx512vl"), gnu::flatten]] void name##Of16(const Arguments& arguments) {  \
        name##Body(arguments);                                                                                         \
    }                                                                                                                  \
    [[gnu::target("avx2"), gnu::flatten]] void name##Of8(const Arguments& arguments) {                                 \
        name##Body(arguments);                                                                                         \
    }                                                                                                                  \
    [[gnu::flatten]] void name##Of4(const Arguments& arguments) {                                                      \
        name##Body(arguments);                                                                                         \
    }                                                                                                                  \
    void name(const Arguments& arguments) {                                                                            \
        const int width = laneWidth();                                                                                 \
        (width == 16 ? name##Of16 : width == 8 ? name##Of8 : name##Of4)(arguments);                                    \
    }
#else
#define PATINA_LANE_BODY inline
#define PATINA_LANES
#define PATINA_LANE_KERNEL(name, Arguments)                                                                            \
    void name(const Arguments& arguments) {                                                                            \
        name##Body(arguments);                                                                                         \
    }
#endif
