#include "optics/layer_stack.h"

#include "base/errors.h"
#include "optics/colour.h"
#include "optics/fresnel.h"
#include "optics/kubelka_munk.h"
#include "optics/stack_kernel.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

using Imath::V3d;
using Imath::V3f;

/// Thicker than this is the same as opaque or, for what neither absorbs nor scatters, the same as nothing.
constexpr float thickestUm = 1e6f;
/// Dielectrics that reflect less than this at normal incidence are taken to reflect less than all at grazing too: an
/// interface that fades out must fade at every angle.
constexpr float fullEdgeReflectance = 0.02f;

/// How much of its own interface a film of this thickness has, 0…1: x⁴ / (1 + x⁴).
float interfaceWeight(float thicknessUm) {
    const float x = thicknessUm / StackOptics::interfaceThicknessUm;
    const float x2 = x * x;
    const float x4 = x2 * x2;
    return x < 100.f ? x4 / (1.f + x4) : 1.f;
}

float normalDielectric(float below, float above) {
    const float ratio = (below - above) / (below + above);
    return ratio * ratio;
}

/// Whether two materials look the same at any thickness.
bool sameOptics(const Material& a, const Material& b) {
    return &a == &b ||
           (a.isMetal == b.isMetal && a.refractiveIndex == b.refractiveIndex && a.roughness == b.roughness &&
            a.hasIndex == b.hasIndex && a.absorption.values == b.absorption.values &&
            a.scattering.values == b.scattering.values && a.reflectance.values == b.reflectance.values &&
            a.indexN.values == b.indexN.values && a.indexK.values == b.indexK.values);
}

const StackKernel& kernel() {
    static const StackKernel chosen = stackKernel();
    return chosen;
}

V3f clippedToGamut(const float* rgb) {
    return {std::max(rgb[0], 0.f), std::max(rgb[1], 0.f), std::max(rgb[2], 0.f)};
}

V3f clamped01(const V3f& rgb) {
    return {std::clamp(rgb.x, 0.f, 1.f), std::clamp(rgb.y, 0.f, 1.f), std::clamp(rgb.z, 0.f, 1.f)};
}

} // namespace

/// The layers that are there, from bottom to top. Neighbours of one material are one layer: there is no interface
/// between them, and what depends on thickness (interference, a surface of its own) must not see where it was cut.
struct StackOptics::PresentLayers {
    int count = 0;
    int index[maxLayers]; ///< of the uppermost where several are one
    float thicknessUm[maxLayers];
    float weight[maxLayers];
};

void StackOptics::Layer::setBand(int band, double absorptionPerUm, double scatteringPerUm) {
    const LayerOptics optics = LayerOptics::of(absorptionPerUm, scatteringPerUm);
    kappa[band] = optics.kappa;
    scattering[band] = optics.scattering;
    absorption[band] = optics.absorption;
    extinction[band] = optics.extinction;
}

StackOptics::StackOptics(const std::vector<const Material*>& materials, Model model, const StackFeatures& features)
    : rgbWeights_(bandWeights(features.colourSpace)), features_(features), model_(model) {
    for (int channel = 0; channel < 3; ++channel) {
        V3d one(0.0);
        one[channel] = 1.0;
        luminance_[channel] = static_cast<float>(xyzFromLinear(one, features.colourSpace).y);
    }
    if (materials.empty()) {
        throw RunError("optics", "a stack needs a base material");
    }
    if (materials.size() > static_cast<std::size_t>(maxLayers) + 1) {
        throw RunError("optics", "a stack may have at most " + std::to_string(maxLayers) + " layers, this one has " +
                                     std::to_string(materials.size() - 1));
    }
    for (const Material* material : materials) {
        Layer layer;
        for (int band = 0; band < bandCount; ++band) {
            layer.setBand(band, material->absorption[band], material->scattering[band]);
        }
        layer.reflectance = material->reflectance;
        layer.refractiveIndex = std::max(material->refractiveIndex, 1.f);
        layer.alpha = ggxAlpha(material->roughness);
        layer.roughness = material->roughness;
        layer.isMetal = material->isMetal;
        layer.specular = material->isMetal ? material->reflectance
                                           : Spectrum::constant(normalDielectric(layer.refractiveIndex, 1.f));
        if (material->isMetal && layers_.size() > 0) {
            // A metal inside the stack hides what is below: a film that reflects as the metal does at any thickness a
            // picture can show. R∞ of K, S is the metal's reflectance; 50 / µm is a skin of some ten nanometres.
            for (int band = 0; band < bandCount; ++band) {
                const double r = std::clamp(material->reflectance[band], 0.01f, 0.99f);
                layer.setBand(band, 50.0 * absorptionOverScattering(r), 50.0);
            }
            layer.refractiveIndex = 1.f;
        }
        if (features.thinFilm && !layers_.empty() && !material->isMetal && material->hasIndex &&
            materials[0]->hasIndex) {
            layer.thinFilm = static_cast<int>(thinFilms_.size());
            thinFilms_.emplace_back(*materials[0], *material);
        }
        layer.kind = static_cast<int>(layers_.size());
        for (std::size_t below = layers_.size(); below-- > 1;) {
            if (sameOptics(*materials[below], *material)) {
                layer.kind = layers_[below].kind;
                break;
            }
        }
        layers_.push_back(layer);
    }
    for (std::size_t i = 0; i < internalReflectance_.size(); ++i) {
        internalReflectance_[i] =
            static_cast<float>(diffuseInterface(1.0 + 2.0 * i / (internalReflectance_.size() - 1)).internal);
    }
}

namespace {

float lookUpInternal(const std::array<float, 65>& table, float index) {
    const float position = std::clamp((index - 1.f) * 32.f, 0.f, 63.999f);
    const int below = static_cast<int>(position);
    return table[below] + (position - below) * (table[below + 1] - table[below]);
}

} // namespace

StackOptics StackOptics::in(ColourSpace space) const {
    StackOptics result = *this;
    result.features_.colourSpace = space;
    result.rgbWeights_ = bandWeights(space);
    for (int channel = 0; channel < 3; ++channel) {
        V3d one(0.0);
        one[channel] = 1.0;
        result.luminance_[channel] = static_cast<float>(xyzFromLinear(one, space).y);
    }
    return result;
}

StackOptics::PresentLayers StackOptics::presentLayers(const float* thicknessUm) const {
    PresentLayers present;
    for (int k = 0; k < layerCount(); ++k) {
        const float d = thicknessUm[k];
        if (!(d > 0.f)) { // true for NaN too
            continue;
        }
        const bool goesOn = present.count > 0 && layers_[present.index[present.count - 1]].kind == layers_[k + 1].kind;
        const int at = goesOn ? present.count - 1 : present.count++;
        present.index[at] = k + 1;
        present.thicknessUm[at] = std::min(goesOn ? present.thicknessUm[at] + d : d, thickestUm);
    }
    for (int i = 0; i < present.count; ++i) {
        present.weight[i] = interfaceWeight(present.thicknessUm[i]);
    }
    return present;
}

float StackOptics::interference(const PresentLayers& present, Spectrum& reflectance) const {
    if (thinFilms_.empty() || present.count == 0 || layers_[present.index[0]].thinFilm < 0) {
        return 0.f;
    }
    const float share = interferingShare(present.thicknessUm[0]);
    if (share > 0.f) {
        thinFilms_[layers_[present.index[0]].thinFilm].lookUp(present.thicknessUm[0], reflectance);
    }
    return share;
}

void StackOptics::evaluate(const float* thicknessUm, Appearance& out) const {
    out.model = model_;
    out.lobes.resize(layers_.size());
    const PresentLayers present = presentLayers(thicknessUm);
    Spectrum underFilm;
    const float share = interference(present, underFilm);
    if (share <= 0.f) {
        evaluateOver(layers_[0].reflectance, present, out);
        return;
    }
    PresentLayers rest = present; // the film is part of the metal's reflectance
    --rest.count;
    std::copy(present.index + 1, present.index + present.count, rest.index);
    std::copy(present.thicknessUm + 1, present.thicknessUm + present.count, rest.thicknessUm);
    std::copy(present.weight + 1, present.weight + present.count, rest.weight);
    evaluateOver(underFilm, rest, out);
    if (share >= 1.f) {
        return;
    }
    // Between the two, a mean of both: it conserves energy as both do.
    const std::size_t count = layers_.size();
    const struct {
        V3f diffuse, baseColour;
        float metallic, flattenedRoughness, specular;
    } interfering = {out.diffuse, out.baseColour, out.metallic, out.flattenedRoughness, out.specular};
    Lobe lobes[maxLayers + 1];
    std::copy(out.lobes.begin(), out.lobes.end(), lobes);
    evaluateOver(layers_[0].reflectance, present, out);
    const auto mix = [share](auto& to, const auto& from) { to += (from - to) * share; };
    mix(out.diffuse, interfering.diffuse);
    for (std::size_t i = 0; i < count; ++i) {
        mix(out.lobes[i].colour, lobes[i].colour);
        mix(out.lobes[i].edgeColour, lobes[i].edgeColour);
        mix(out.lobes[i].air, lobes[i].air);
        mix(out.lobes[i].airEdge, lobes[i].airEdge);
    }
    mix(out.baseColour, interfering.baseColour);
    mix(out.metallic, interfering.metallic);
    mix(out.flattenedRoughness, interfering.flattenedRoughness);
    mix(out.specular, interfering.specular);
}

void StackOptics::evaluateOver(const Spectrum& base, const PresentLayers& present, Appearance& out) const {
    if (model_ == Model::paper) {
        evaluatePaper(base, present, out);
    } else {
        evaluateConserving(base, present, out);
    }
}

Spectrum StackOptics::bodyReflectance(const float* thicknessUm) const {
    const PresentLayers present = presentLayers(thicknessUm);
    KernelInput input;
    input.count = present.count;
    input.base = &layers_[0].reflectance;
    for (int k = 0; k < present.count; ++k) {
        const Layer& layer = layers_[present.index[k]];
        input.layers[k] = {&layer.kappa,      &layer.scattering,      &layer.absorption,
                           &layer.extinction, present.thicknessUm[k], 0.f};
    }
    Spectrum result;
    kernel().foldBody(input, result);
    return result;
}

void StackOptics::evaluateConserving(const Spectrum& base, const PresentLayers& present, Appearance& out) const {
    KernelInput input;
    input.count = present.count;
    input.base = &base;
    input.rgbWeights = rgbWeights_.data();
    float surfaceIndex = 1.f; // bare metal meets the air by its own n and k
    for (int k = 0; k < present.count; ++k) {
        const Layer& layer = layers_[present.index[k]];
        float interfaceAbove = 0.f;
        if (k + 1 < present.count) {
            const Layer& above = layers_[present.index[k + 1]];
            interfaceAbove = present.weight[k] * present.weight[k + 1] *
                             normalDielectric(layer.refractiveIndex, above.refractiveIndex);
        }
        surfaceIndex += present.weight[k] * (layer.refractiveIndex - surfaceIndex);
        input.layers[k] = {&layer.kappa,      &layer.scattering,      &layer.absorption,
                           &layer.extinction, present.thicknessUm[k], interfaceAbove};
    }
    const float airReflectance = normalDielectric(surfaceIndex, 1.f);
    const float airEdge = std::min(1.f, airReflectance / fullEdgeReflectance);
    input.k1 = airReflectance;
    input.k2 = lookUpInternal(internalReflectance_, surfaceIndex);
    input.wantEdge = airEdge < 1.f;

    KernelOutput output;
    kernel().foldConserving(input, output);

    for (std::size_t i = 0; i < layers_.size(); ++i) {
        Lobe& lobe = out.lobes[i];
        lobe.colour = lobe.edgeColour = V3f(0.f);
        lobe.air = lobe.airEdge = 0.f;
        lobe.alpha = layers_[i].alpha;
        lobe.roughness = layers_[i].roughness;
    }
    out.diffuse = clippedToGamut(output.diffuse);
    V3f bodySum = out.diffuse;
    out.lobes[0].colour = clippedToGamut(output.lobes[0]);
    bodySum += out.lobes[0].colour;
    for (int k = 0; k < present.count; ++k) {
        Lobe& lobe = out.lobes[present.index[k]];
        lobe.colour = clippedToGamut(output.lobes[k + 1]);
        bodySum += lobe.colour;
    }
    // A spectrum below 1 may still leave the gamut (gold's red is 1.04): clip, so that the channels conserve too.
    const float most = 1.f - airReflectance;
    for (int channel = 0; channel < 3; ++channel) {
        if (bodySum[channel] > most) {
            const float scale = most / bodySum[channel];
            out.diffuse[channel] *= scale;
            for (Lobe& lobe : out.lobes) {
                lobe.colour[channel] *= scale;
            }
            bodySum[channel] = most;
        }
    }
    if (input.wantEdge) {
        const V3f edge = clippedToGamut(output.edge);
        Lobe& metal = out.lobes[0];
        for (int channel = 0; channel < 3; ++channel) {
            const float room = most - (bodySum[channel] - metal.colour[channel]);
            const float rising = std::max(std::min(edge[channel], room), metal.colour[channel]);
            metal.edgeColour[channel] = metal.colour[channel] + (1.f - airEdge) * (rising - metal.colour[channel]);
        }
    } else {
        out.lobes[0].edgeColour = out.lobes[0].colour;
    }
    for (int k = 0; k < present.count; ++k) {
        Lobe& lobe = out.lobes[present.index[k]];
        lobe.edgeColour = lobe.colour;
    }
    // The air's reflection has the roughness of the topmost film; as that film fades out, of the one below it.
    float left = 1.f;
    for (int k = present.count - 1; k >= -1; --k) {
        const float share = k >= 0 ? left * present.weight[k] : left;
        left -= share;
        Lobe& lobe = out.lobes[k >= 0 ? present.index[k] : 0];
        lobe.air = share * airReflectance;
        lobe.airEdge = share * airEdge;
        lobe.colour += V3f(lobe.air);
        lobe.edgeColour += V3f(lobe.airEdge);
    }

    flatten(airReflectance, out);
}

// What metals mirror against what is scattered gives `metallic`; the width is the mean of the lobes' alpha², each by
// its brightness.
void StackOptics::flatten(float airReflectance, Appearance& out) const {
    V3f metal(0.f);
    float brightness = 0.f;
    float width = 0.f;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        const Lobe& lobe = out.lobes[i];
        if (layers_[i].isMetal) {
            metal += lobe.colour - V3f(lobe.air);
        }
        const float weight = luminance(lobe.colour);
        brightness += weight;
        width += weight * lobe.alpha * lobe.alpha;
    }
    const float mirrored = luminance(metal);
    const float total = mirrored + luminance(out.diffuse);
    out.metallic = total > 0.f ? mirrored / total : 0.f;
    out.baseColour = clamped01(metal + out.diffuse);
    out.flattenedRoughness = brightness > 1e-6f ? std::sqrt(std::sqrt(std::min(width / brightness, 1.f))) : 1.f;
    out.specular = std::min(airReflectance / 0.08f, 1.f);
}

void StackOptics::evaluatePaper(const Spectrum& metal, const PresentLayers& present, Appearance& out) const {
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        Lobe& lobe = out.lobes[i];
        lobe = Lobe{};
        lobe.alpha = layers_[i].alpha;
        lobe.roughness = layers_[i].roughness;
    }
    Spectrum diffuse;
    Spectrum lobes[maxLayers + 1]; // [0] the metal, [k] present layer k - 1
    for (int band = 0; band < bandCount; ++band) {
        // From the top down, so that the transmittance of all that lies above an interface is at hand.
        StackLight<float> above;
        for (int k = present.count - 1; k >= 0; --k) {
            const Layer& layer = layers_[present.index[k]];
            lobes[k + 1][band] = layer.specular[band] * above.transmittance * above.transmittance;
            above = onTop(above, StackLight<float>(kubelkaMunkLayer(layer.absorption[band] * layer.kappa[band],
                                                                    layer.scattering[band] * layer.kappa[band],
                                                                    present.thicknessUm[k])));
        }
        lobes[0][band] = metal[band] * above.transmittance * above.transmittance;
        const float base = metal[band];
        diffuse[band] = above.reflectanceAbove +
                        above.transmittance * base * interreflected(above.transmittance, above.reflectanceBelow, base);
    }
    const auto rgbOf = [this](const Spectrum& spectrum) {
        return clamped01(V3f(linearFromXyz(xyzFromReflectance(spectrum), features_.colourSpace)));
    };
    out.diffuse = rgbOf(diffuse);
    out.lobes[0].colour = out.lobes[0].edgeColour = rgbOf(lobes[0]);
    for (int k = 0; k < present.count; ++k) {
        Lobe& lobe = out.lobes[present.index[k]];
        lobe.colour = lobe.edgeColour = rgbOf(lobes[k + 1]);
    }
    const float top = present.count > 0 ? layers_[present.index[present.count - 1]].refractiveIndex : 1.f;
    flatten(normalDielectric(top, 1.f), out);
}

} // namespace patina
