// Vectors wider than the baseline's stay inside functions that are built for them, so their calling convention is moot.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "optics/stack_kernel.h"

#include "optics/band_lanes.h"

namespace patina {

namespace {

/// An interface weaker than this cannot be seen; leaving it out saves an exponential.
constexpr float weakestInterface = 1e-6f;

/// R <- reflectance of the layer over a background R (kubelka_munk.h). Both fractions of it,
/// R0 + T² R / (1 - R0 R) with R0 = S g / D and T = e / D, over the one denominator D (D - S g R).
template <int width>
PATINA_INLINE void foldLayer(const KernelLayer& layer, BandLanes<width>& reflectance) {
    using Bands = BandLanes<width>;
    const float d = layer.thicknessUm;
    const Bands tau = Bands::load(*layer.kappa) * d;
    const Bands e = expOfMinus(tau);
    const Bands e2 = e * e;
    const Bands series = (1.f - tau * (1.f - tau * (0.66666667f - tau * 0.33333333f))) * d;
    const Bands closed = (1.f - e2) * Bands::load(*layer.halfOverKappa);
    const Bands g = whereGreater(tau, 0.02f, closed, series);
    const Bands sg = Bands::load(*layer.scattering) * g;
    const Bands divisor = Bands::load(*layer.extinction) * g + (e2 + 1.f) * 0.5f;
    const Bands rest = divisor - sg * reflectance;
    reflectance = (sg * rest + e2 * reflectance) / (divisor * rest);
}

template <int width>
PATINA_INLINE void projectToRgb(const BandLanes<width>& spectrum, const Spectrum* weights, float* rgb) {
    for (int channel = 0; channel < 3; ++channel) {
        rgb[channel] = dotBands(spectrum, BandLanes<width>::load(weights[channel]));
    }
}

template <int width>
PATINA_INLINE void foldBodyIn(const KernelInput& input, Spectrum& result) {
    BandLanes<width> reflectance = BandLanes<width>::load(*input.base);
    for (int k = 0; k < input.count; ++k) {
        foldLayer(input.layers[k], reflectance);
    }
    reflectance.store(result);
}

template <int width>
PATINA_INLINE void foldConservingIn(const KernelInput& input, KernelOutput& output) {
    using Bands = BandLanes<width>;
    const Bands metal = Bands::load(*input.base);
    Bands reflectance = metal;
    for (int k = 0; k < input.count; ++k) {
        foldLayer(input.layers[k], reflectance);
        const float f = input.layers[k].interfaceAbove;
        if (f > weakestInterface) {
            reflectance = f + ((1.f - f) * (1.f - f)) * reflectance / (1.f - f * reflectance);
        }
    }
    // Unscattered light, from the top down: to an interface and back it loses exp(-2 Σ (K + S) d) and what the
    // interfaces on its way reflect.
    const float outside = (1.f - input.k1) * (1.f - input.k1);
    Bands glossy = Bands::constant(0.f);
    Bands depth = Bands::constant(0.f);
    float passed = 1.f;
    for (int k = input.count - 1; k >= 0; --k) {
        const KernelLayer& layer = input.layers[k];
        const float f = layer.interfaceAbove;
        float* lobe = output.lobes[k + 1];
        lobe[0] = lobe[1] = lobe[2] = 0.f;
        if (f > weakestInterface) {
            const Bands through = expOfMinus(depth * 2.f) * (f * passed);
            glossy = glossy + through;
            projectToRgb(through * outside, input.rgbWeights, lobe);
            passed *= (1.f - f) * (1.f - f);
        }
        depth = depth + Bands::load(*layer.extinction) * layer.thicknessUm;
    }
    const Bands through = expOfMinus(depth * 2.f) * passed;
    const Bands mirrored = through * metal;
    glossy = glossy + mirrored;
    projectToRgb(mirrored * outside, input.rgbWeights, output.lobes[0]);
    if (input.wantEdge) {
        projectToRgb(through * outside, input.rgbWeights, output.edge);
    }
    // What comes up diffusely meets the air interface from within (Saunderson); of the glossy light k1 is turned back
    // and is diffuse from then on.
    const Bands difference = reflectance - glossy;
    const Bands scattered = whereGreater(difference, 0.f, difference, Bands::constant(0.f));
    const Bands diffuse = ((scattered + glossy * reflectance * input.k1) * ((1.f - input.k1) * (1.f - input.k2))) /
                          (1.f - reflectance * input.k2);
    projectToRgb(diffuse, input.rgbWeights, output.diffuse);
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) void foldBody16(const KernelInput& input, Spectrum& result) {
    foldBodyIn<16>(input, result);
}
__attribute__((target("avx512f"))) void foldConserving16(const KernelInput& input, KernelOutput& output) {
    foldConservingIn<16>(input, output);
}
__attribute__((target("avx2"))) void foldBody8(const KernelInput& input, Spectrum& result) {
    foldBodyIn<8>(input, result);
}
__attribute__((target("avx2"))) void foldConserving8(const KernelInput& input, KernelOutput& output) {
    foldConservingIn<8>(input, output);
}
#endif
void foldBody4(const KernelInput& input, Spectrum& result) {
    foldBodyIn<4>(input, result);
}
void foldConserving4(const KernelInput& input, KernelOutput& output) {
    foldConservingIn<4>(input, output);
}

} // namespace

StackKernel stackKernel(int width) {
#if defined(__x86_64__)
    if (width >= 16 && __builtin_cpu_supports("avx512f")) {
        return {foldBody16, foldConserving16};
    }
    if (width >= 8 && __builtin_cpu_supports("avx2")) {
        return {foldBody8, foldConserving8};
    }
#else
    (void)width;
#endif
    return {foldBody4, foldConserving4};
}

} // namespace patina
