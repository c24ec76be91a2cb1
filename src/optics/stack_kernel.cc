#include "optics/stack_kernel.h"

#include "optics/band_lanes.h"

// One build for machines with wider registers each, chosen when the program starts. Sanitizers cannot look through that.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) &&                           \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PATINA_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PATINA_CLONES
#endif

namespace patina {

namespace {

/// An interface weaker than this cannot be seen; leaving it out saves an exponential.
constexpr float weakestInterface = 1e-6f;

/// R <- reflectance of the layer over a background R (kubelka_munk.h). Both fractions of it,
/// R0 + T² R / (1 - R0 R) with R0 = S g / D and T = e / D, over the one denominator D (D - S g R).
PATINA_INLINE void foldLayer(const KernelLayer& layer, BandLanes& reflectance) {
    BandLanes kappa, scattering, extinction, halfOverKappa;
    loadBands(*layer.kappa, kappa);
    loadBands(*layer.scattering, scattering);
    loadBands(*layer.extinction, extinction);
    loadBands(*layer.halfOverKappa, halfOverKappa);
    const float d = layer.thicknessUm;
    const BandLanes tau = kappa * d;
    BandLanes e;
    expBands(-tau, e);
    const BandLanes e2 = e * e;
    const BandLanes series = (1.f - tau * (1.f - tau * (0.66666667f - tau * 0.33333333f))) * d;
    const BandLanes closed = (1.f - e2) * halfOverKappa;
    const BandLanes g = tau > 0.02f ? closed : series;
    const BandLanes sg = scattering * g;
    const BandLanes divisor = extinction * g + (e2 + 1.f) * 0.5f;
    const BandLanes rest = divisor - sg * reflectance;
    reflectance = (sg * rest + e2 * reflectance) / (divisor * rest);
}

PATINA_INLINE void projectToRgb(const BandLanes& spectrum, const Spectrum* weights, float* rgb) {
    for (int channel = 0; channel < 3; ++channel) {
        BandLanes weight;
        loadBands(weights[channel], weight);
        rgb[channel] = dotBands(spectrum, weight);
    }
}

} // namespace

PATINA_CLONES void foldBody(const KernelInput& input, Spectrum& result) {
    BandLanes reflectance;
    loadBands(*input.base, reflectance);
    for (int k = 0; k < input.count; ++k) {
        foldLayer(input.layers[k], reflectance);
    }
    std::memcpy(result.values.data(), &reflectance, sizeof(reflectance));
}

PATINA_CLONES void foldConserving(const KernelInput& input, KernelOutput& output) {
    BandLanes metal;
    loadBands(*input.base, metal);
    BandLanes reflectance = metal;
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
    BandLanes glossy = {};
    BandLanes depth = {};
    float passed = 1.f;
    for (int k = input.count - 1; k >= 0; --k) {
        const KernelLayer& layer = input.layers[k];
        const float f = layer.interfaceAbove;
        float* lobe = output.lobes[k + 1];
        lobe[0] = lobe[1] = lobe[2] = 0.f;
        if (f > weakestInterface) {
            BandLanes through;
            expBands(depth * -2.f, through);
            through = through * (f * passed);
            glossy = glossy + through;
            projectToRgb(through * outside, input.rgbWeights, lobe);
            passed *= (1.f - f) * (1.f - f);
        }
        BandLanes extinction;
        loadBands(*layer.extinction, extinction);
        depth = depth + extinction * layer.thicknessUm;
    }
    BandLanes through;
    expBands(depth * -2.f, through);
    through = through * passed;
    const BandLanes mirrored = through * metal;
    glossy = glossy + mirrored;
    projectToRgb(mirrored * outside, input.rgbWeights, output.lobes[0]);
    if (input.wantEdge) {
        projectToRgb(through * outside, input.rgbWeights, output.edge);
    }
    // What comes up diffusely meets the air interface from within (Saunderson); of the glossy light k1 is turned back
    // and is diffuse from then on.
    const BandLanes scatteredRaw = reflectance - glossy;
    const BandLanes scattered = scatteredRaw > 0.f ? scatteredRaw : BandLanes{};
    const BandLanes diffuse = ((scattered + glossy * reflectance * input.k1) * ((1.f - input.k1) * (1.f - input.k2))) /
                              (1.f - reflectance * input.k2);
    projectToRgb(diffuse, input.rgbWeights, output.diffuse);
}

} // namespace patina
