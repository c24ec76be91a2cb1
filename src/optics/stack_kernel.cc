// Vectors wider than the baseline's stay inside functions that are built for them, so their calling convention is moot.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "optics/stack_kernel.h"

#include "optics/band_lanes.h"

namespace patina {

namespace {

/// An interface weaker than this cannot be seen; leaving it out saves an exponential.
constexpr float weakestInterface = 1e-6f;

/// The reflectance so far, R = back / (back + lost): so a stack takes one division and not one for each layer.
template <int width>
struct Fraction {
    BandLanes<width> back;
    BandLanes<width> lost;

    static PATINA_INLINE Fraction of(const BandLanes<width>& reflectance) { return {reflectance, 1.f - reflectance}; }
    PATINA_INLINE BandLanes<width> whole() const { return back + lost; }
    PATINA_INLINE BandLanes<width> value() const { return back / whole(); }
};

/// After so many layers the fraction is divided out: each multiplies it by 1/2 … 1e6.
constexpr int layersPerDivision = 4;

/// R <- R0 + T² R / (1 - R0 R), the layer over a background R (kubelka_munk.h). With h = (1 - exp(-2 kappa d)) / 2 and
/// K, S per kappa it is a linear map of `back` and `lost`; K <= 1 and h <= 1/2, so no term is negative and nothing
/// cancels.
template <int width>
PATINA_INLINE Fraction<width> withLayer(const LayerSpectra& layer, const BandLanes<width>& h,
                                        const Fraction<width>& background) {
    using Bands = BandLanes<width>;
    const Bands backToBack = fused(h, Bands::load(layer.minusOnePlus), Bands::constant(1.f));
    const Bands backToLost = h * Bands::load(layer.twoAbsorption);
    const Bands lostToLost = fused(h, Bands::load(layer.minusOneMinus), Bands::constant(1.f));
    const Bands lostToBack = h * Bands::load(layer.scattering);
    return {fused(background.back, backToBack, background.lost * lostToBack),
            fused(background.lost, lostToLost, background.back * backToLost)};
}

/// The layers over the base, the interfaces between them too where `interfaces` says so.
template <int width, bool interfaces>
PATINA_INLINE Fraction<width> foldStack(const KernelInput& input) {
    using Bands = BandLanes<width>;
    Fraction<width> reflectance = Fraction<width>::of(Bands::load(*input.base));
    for (int k = 0; k < input.count; ++k) {
        if (k > 0 && k % layersPerDivision == 0) {
            const Bands perWhole = 1.f / reflectance.whole();
            reflectance = {reflectance.back * perWhole, reflectance.lost * perWhole};
        }
        const KernelLayer& layer = input.layers[k];
        const Bands h = halfGone(Bands::load(layer.optics->twoKappa) * layer.thicknessUm);
        reflectance = withLayer(*layer.optics, h, reflectance);
        if (interfaces) { // F + (1 - F)² R / (1 - F R), which is R for F = 0: there is no branch
            const float f = layer.interfaceAbove;
            reflectance.back = fused(reflectance.lost, f / (1.f - f), reflectance.back);
        }
    }
    return reflectance;
}

template <int width>
PATINA_INLINE void foldBodyIn(const KernelInput& input, Spectrum& result) {
    foldStack<width, false>(input).value().store(result);
}

/// A spectrum below 1 may leave the gamut: a deep orange's blue is negative. Such a channel is 0.
template <int width>
PATINA_INLINE RgbLanes inGamut(const BandLanes<width>& bands, const ChannelWeights& weights) {
    const RgbLanes rgb = toRgb(bands, weights);
    return rgb > 0.f ? rgb : RgbLanes{};
}

template <int width>
PATINA_INLINE void foldConservingIn(const KernelInput& input, KernelOutput& output) {
    using Bands = BandLanes<width>;
    const Fraction<width> reflectance = foldStack<width, true>(input);
    // Begun here, so that it is done when the lobes are.
    const Bands perRest = 1.f / (reflectance.lost + reflectance.back * (1.f - input.k2));
    const Bands metal = Bands::load(*input.base);
    // Unscattered light, from the top down: to an interface and back it loses exp(-2 Σ (K + S) d) and what the
    // interfaces on its way reflect.
    const float outside = (1.f - input.k1) * (1.f - input.k1);
    Bands glossy = Bands::constant(0.f);
    Bands depth = Bands::constant(0.f);
    float passed = 1.f;
    RgbLanes lobeSum{};
    for (int k = input.count - 1; k >= 0; --k) {
        const KernelLayer& layer = input.layers[k];
        const float f = layer.interfaceAbove;
        RgbLanes lobe{};
        if (f > weakestInterface) {
            const Bands through = remaining(depth) * (f * passed);
            glossy = glossy + through;
            lobe = inGamut(through, *input.weights) * outside;
            lobeSum = lobeSum + lobe;
            passed *= (1.f - f) * (1.f - f);
        }
        output.lobes[k + 1] = lobe;
        depth = fused(Bands::load(layer.optics->twoExtinction), layer.thicknessUm, depth);
    }
    const Bands through = remaining(depth) * passed;
    const Bands mirrored = through * metal;
    glossy = glossy + mirrored;
    output.lobes[0] = inGamut(mirrored, *input.weights) * outside;
    output.lobeSum = lobeSum + output.lobes[0];
    if (input.wantEdge) {
        output.edge = inGamut(through, *input.weights) * outside;
    }
    // What comes up diffusely meets the air interface from within (Saunderson); of the glossy light k1 is turned back
    // and is diffuse from then on.
    const Bands difference = reflectance.back - glossy * reflectance.whole();
    const Bands scattered = whereGreater(difference, 0.f, difference, Bands::constant(0.f));
    const Bands diffuse = (scattered + glossy * reflectance.back * input.k1) * perRest;
    output.diffuse = inGamut(diffuse, *input.weights) * ((1.f - input.k1) * (1.f - input.k2));
}

template <int width>
PATINA_INLINE void foldPaperIn(const KernelInput& input, KernelOutput& output) {
    using Bands = BandLanes<width>;
    output.diffuse = toRgb(foldStack<width, false>(input).value(), *input.weights);
    // From the top down: what lies above an interface lets T through and reflects `below` from its underside. One more
    // layer makes of T, times exp(-kappa d), over the whole of the same fraction.
    Fraction<width> below = Fraction<width>::of(Bands::constant(0.f));
    Bands transmittance = Bands::constant(1.f);
    for (int k = input.count - 1; k >= 0; --k) {
        const KernelLayer& layer = input.layers[k];
        output.lobes[k + 1] = toRgb(Bands::load(*layer.specular) * (transmittance * transmittance), *input.weights);
        const Decay<width> e = decay(Bands::load(layer.optics->twoKappa) * (0.5f * layer.thicknessUm));
        const Bands h = e.gone * (0.5f + 0.5f * e.left); // (1 - exp(-2 kappa d)) / 2
        below = withLayer<width>(*layer.optics, h, below);
        const Bands perWhole = 1.f / below.whole();
        below = {below.back * perWhole, below.lost * perWhole};
        transmittance = transmittance * e.left * perWhole;
    }
    output.lobes[0] = toRgb(Bands::load(*input.base) * (transmittance * transmittance), *input.weights);
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) void foldBody16(const KernelInput& input, Spectrum& result) {
    foldBodyIn<16>(input, result);
}
__attribute__((target("avx512f"))) void foldConserving16(const KernelInput& input, KernelOutput& output) {
    foldConservingIn<16>(input, output);
}
__attribute__((target("avx512f"))) void foldPaper16(const KernelInput& input, KernelOutput& output) {
    foldPaperIn<16>(input, output);
}
__attribute__((target("avx2"))) void foldBody8(const KernelInput& input, Spectrum& result) {
    foldBodyIn<8>(input, result);
}
__attribute__((target("avx2"))) void foldConserving8(const KernelInput& input, KernelOutput& output) {
    foldConservingIn<8>(input, output);
}
__attribute__((target("avx2"))) void foldPaper8(const KernelInput& input, KernelOutput& output) {
    foldPaperIn<8>(input, output);
}
#endif
void foldBody4(const KernelInput& input, Spectrum& result) {
    foldBodyIn<4>(input, result);
}
void foldConserving4(const KernelInput& input, KernelOutput& output) {
    foldConservingIn<4>(input, output);
}
void foldPaper4(const KernelInput& input, KernelOutput& output) {
    foldPaperIn<4>(input, output);
}

} // namespace

ChannelWeights channelWeights(const std::array<Spectrum, 3>& rgb) {
    ChannelWeights weights;
    for (int band = 0; band < bandCount; ++band) {
        for (int channel = 0; channel < 3; ++channel) {
            weights[band % 4][band - band % 4 + channel] = rgb[channel][band];
        }
    }
    return weights;
}

StackKernel stackKernel(int width) {
#if defined(__x86_64__)
    if (width >= 16 && __builtin_cpu_supports("avx512f")) {
        return {foldBody16, foldConserving16, foldPaper16};
    }
    if (width >= 8 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        return {foldBody8, foldConserving8, foldPaper8};
    }
#else
    (void)width;
#endif
    return {foldBody4, foldConserving4, foldPaper4};
}

const StackKernel& bestStackKernel() {
    static const StackKernel chosen = stackKernel(16);
    return chosen;
}

} // namespace patina
