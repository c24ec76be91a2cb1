// Vectors wider than the baseline's stay inside functions that are built for them, so their calling convention is moot.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "optics/stack_kernel.h"

#include "optics/band_lanes.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

/// An interface weaker than this cannot be seen; leaving it out saves an exponential.
constexpr float weakestInterface = 1e-6f;

/// The reflectance so far as a fraction, so that a stack takes one division and not one for each layer.
template <int width>
struct Fraction {
    BandLanes<width> over;
    BandLanes<width> under; ///< over / under is 0…1

    PATINA_INLINE BandLanes<width> value() const { return over / under; }
};

/// After so many layers the fraction is divided out: each multiplies `under` by 1 … 2e6.
constexpr int layersPerDivision = 4;

/// R <- reflectance of the layer over a background R (kubelka_munk.h). With e = exp(-kappa d), u = 1 - e² and w = 1 +
/// e² R0 + T² R / (1 - R0 R) becomes (u (S (1 - R) - K R) + kappa w R) / (u (S (1 - R) + K) + kappa w): a fraction goes
/// in, a fraction comes out, and nothing below the line cancels. Over and under are divided by kappa.
template <int width>
PATINA_INLINE void foldLayer(const KernelLayer& layer, Fraction<width>& reflectance) {
    using Bands = BandLanes<width>;
    const Decay<width> e = decay(Bands::load(*layer.kappa) * layer.thicknessUm);
    const Bands u = e.gone * (e.left + 1.f);
    const Bands w = 2.f - u;
    const Bands turned = Bands::load(*layer.scattering) * (reflectance.under - reflectance.over);
    const Bands absorption = Bands::load(*layer.absorption);
    const Bands over = u * (turned - absorption * reflectance.over) + w * reflectance.over;
    reflectance.under = u * (turned + absorption * reflectance.under) + w * reflectance.under;
    reflectance.over = over;
}

/// The layers over the base, the interfaces between them too where `interfaces` says so.
template <int width, bool interfaces>
PATINA_INLINE Fraction<width> foldStack(const KernelInput& input) {
    using Bands = BandLanes<width>;
    Fraction<width> reflectance{Bands::load(*input.base), Bands::constant(1.f)};
    for (int k = 0; k < input.count; ++k) {
        if (k > 0 && k % layersPerDivision == 0) {
            reflectance = {reflectance.value(), Bands::constant(1.f)};
        }
        foldLayer(input.layers[k], reflectance);
        const float f = input.layers[k].interfaceAbove;
        if (interfaces && f > weakestInterface) { // F + (1 - F)² R / (1 - F R)
            const Bands over = reflectance.under * f + reflectance.over * (1.f - 2.f * f);
            reflectance.under = reflectance.under - reflectance.over * f;
            reflectance.over = over;
        }
    }
    return reflectance;
}

template <int width>
PATINA_INLINE void foldBodyIn(const KernelInput& input, Spectrum& result) {
    // A black body may come out at -1e-8.
    const BandLanes<width> reflectance = foldStack<width, false>(input).value();
    whereGreater(reflectance, 0.f, reflectance, BandLanes<width>::constant(0.f)).store(result);
}

template <int width>
PATINA_INLINE void foldConservingIn(const KernelInput& input, KernelOutput& output) {
    using Bands = BandLanes<width>;
    const Fraction<width> reflectance = foldStack<width, true>(input);
    const Bands metal = Bands::load(*input.base);
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
            const Bands through = decay(depth * 2.f).left * (f * passed);
            glossy = glossy + through;
            dotBands(through * outside, input.rgbWeights, lobe);
            passed *= (1.f - f) * (1.f - f);
        }
        depth = depth + Bands::load(*layer.extinction) * layer.thicknessUm;
    }
    const Bands through = decay(depth * 2.f).left * passed;
    const Bands mirrored = through * metal;
    glossy = glossy + mirrored;
    dotBands(mirrored * outside, input.rgbWeights, output.lobes[0]);
    if (input.wantEdge) {
        dotBands(through * outside, input.rgbWeights, output.edge);
    }
    // What comes up diffusely meets the air interface from within (Saunderson); of the glossy light k1 is turned back
    // and is diffuse from then on.
    const Bands difference = reflectance.over - glossy * reflectance.under;
    const Bands scattered = whereGreater(difference, 0.f, difference, Bands::constant(0.f));
    const Bands diffuse = ((scattered + glossy * reflectance.over * input.k1) * ((1.f - input.k1) * (1.f - input.k2))) /
                          (reflectance.under - reflectance.over * input.k2);
    dotBands(diffuse, input.rgbWeights, output.diffuse);
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

LayerOptics LayerOptics::of(double absorption, double scattering) {
    const double kappa =
        std::max(std::sqrt(absorption * (absorption + 2.0 * scattering)), 1e-6 * (absorption + scattering));
    const double perKappa = kappa > 0.0 ? 1.0 / kappa : 0.0;
    return {static_cast<float>(kappa), static_cast<float>(scattering * perKappa),
            static_cast<float>(absorption * perKappa), static_cast<float>(absorption + scattering)};
}

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
