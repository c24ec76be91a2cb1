#include "optics/layer_stack.h"

#include "base/errors.h"
#include "optics/colour.h"
#include "optics/fresnel.h"
#include "optics/kubelka_munk.h"
#include "optics/present_layers.h"
#include "optics/stack_kernel.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

using Imath::V3d;
using Imath::V3f;

/// Thicker than this is the same as opaque or, for what neither absorbs nor scatters, the same as nothing.
constexpr float thickestUm = 1e6f;

/// How much of its own interface a film of this thickness has, 0…1: x⁴ / (1 + x⁴).
float interfaceWeight(float thicknessUm) {
    const float x = thicknessUm * (1.f / StackOptics::interfaceThicknessUm);
    const float x2 = x * x;
    const float x4 = x2 * x2;
    return x < 100.f ? x4 / (1.f + x4) : 1.f;
}

/// Whether two materials look the same at any thickness.
bool sameOptics(const Material& a, const Material& b) {
    return &a == &b ||
           (a.isMetal == b.isMetal && a.refractiveIndex == b.refractiveIndex && a.roughness == b.roughness &&
            a.hasIndex == b.hasIndex && a.absorption.values == b.absorption.values &&
            a.scattering.values == b.scattering.values && a.reflectance.values == b.reflectance.values &&
            a.indexN.values == b.indexN.values && a.indexK.values == b.indexK.values);
}

} // namespace

StackOptics::StackOptics(const std::vector<const Material*>& materials, Model model, const StackFeatures& features)
    : features_(features), model_(model) {
    setColourSpace(features.colourSpace);
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
            layer.optics.setBand(band, material->absorption[band], material->scattering[band]);
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
                layer.optics.setBand(band, 50.0 * absorptionOverScattering(r), 50.0);
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
        Lobe dark;
        dark.alpha = layer.alpha;
        dark.roughness = layer.roughness;
        darkLobes_.push_back(dark);
    }
    for (const Layer& below : layers_) {
        for (const Layer& above : layers_) {
            interfaces_.push_back(normalDielectric(below.refractiveIndex, above.refractiveIndex));
        }
    }
    for (std::size_t i = 0; i < internalReflectance_.size(); ++i) {
        internalReflectance_[i] =
            static_cast<float>(diffuseInterface(1.0 + 2.0 * i / (internalReflectance_.size() - 1)).internal);
    }
}

void StackOptics::setColourSpace(ColourSpace space) {
    features_.colourSpace = space;
    weights_ = channelWeights(bandWeights(space));
    for (int channel = 0; channel < 3; ++channel) {
        V3d one(0.0);
        one[channel] = 1.0;
        luminance_[channel] = static_cast<float>(xyzFromLinear(one, space).y);
    }
}

StackOptics StackOptics::in(ColourSpace space) const {
    StackOptics result = *this;
    result.setColourSpace(space);
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
        input.layers[k] = {&layer.optics, &layer.specular, present.thicknessUm[k], 0.f};
    }
    Spectrum result;
    bestStackKernel().foldBody(input, result);
    return result;
}

} // namespace patina
