// The two models of StackOptics: from what the kernel says of the bands to an Appearance.

#include "optics/layer_stack.h"
#include "optics/present_layers.h"
#include "optics/stack_kernel.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

/// Dielectrics that reflect less than this at normal incidence are taken to reflect less than all at grazing too: an
/// interface that fades out must fade at every angle.
constexpr float fullEdgeReflectance = 0.02f;

RgbLanes clamped01(RgbLanes rgb) {
    return lower(higher(rgb, RgbLanes{}), rgbOf(1.f));
}

bool anyGreater(RgbLanes a, RgbLanes b) {
    return a[0] > b[0] || a[1] > b[1] || a[2] > b[2];
}

float lookUpInternal(const std::array<float, 65>& table, float index) {
    const float position = std::clamp((index - 1.f) * 32.f, 0.f, 63.999f);
    const int below = static_cast<int>(position);
    return table[below] + (position - below) * (table[below + 1] - table[below]);
}

} // namespace

// What metals mirror against what is scattered gives `metallic`; the width is the mean of the lobes' alpha², each by
// its brightness.
inline void StackOptics::flatten(const LightSums& sums, float airReflectance, Appearance& out) const {
    const auto luminance = [this](RgbLanes rgb) {
        return luminance_[0] * rgb[0] + luminance_[1] * rgb[1] + luminance_[2] * rgb[2];
    };
    const float mirrored = luminance(sums.metal);
    const float total = mirrored + luminance(sums.diffuse);
    const float brightness = luminance(sums.lobes);
    out.metallic = total > 0.f ? mirrored / total : 0.f;
    store(clamped01(sums.metal + sums.diffuse), out.baseColour);
    out.flattenedRoughness =
        brightness > 1e-6f ? std::sqrt(std::sqrt(std::min(luminance(sums.width) / brightness, 1.f))) : 1.f;
    out.specular = std::min(airReflectance / 0.08f, 1.f);
}

void StackOptics::evaluateConserving(const Spectrum& base, const PresentLayers& present, Appearance& out) const {
    KernelInput input;
    input.count = present.count;
    input.base = &base;
    input.weights = &weights_;
    float surfaceIndex = 1.f; // bare metal meets the air by its own n and k
    const Layer* const layers = layers_.data();
    const float* const interfaces = interfaces_.data();
    const int layerTotal = static_cast<int>(layers_.size());
    for (int k = 0; k < present.count; ++k) {
        const Layer& layer = layers[present.index[k]];
        float interfaceAbove = 0.f;
        if (k + 1 < present.count) {
            interfaceAbove = present.weight[k] * present.weight[k + 1] *
                             interfaces[present.index[k] * layerTotal + present.index[k + 1]];
        }
        surfaceIndex += present.weight[k] * (layer.refractiveIndex - surfaceIndex);
        input.layers[k] = {&layer.optics, &layer.specular, present.thicknessUm[k], interfaceAbove};
    }
    const float airReflectance = normalDielectric(surfaceIndex, 1.f);
    const float airEdge = std::min(1.f, airReflectance / fullEdgeReflectance);
    input.k1 = airReflectance;
    input.k2 = lookUpInternal(internalReflectance_, surfaceIndex);
    input.wantEdge = airEdge < 1.f;

    KernelOutput output;
    bestStackKernel().foldConserving(input, output);

    RgbLanes lobeSum = output.lobeSum;
    LightSums sums;
    sums.diffuse = output.diffuse;
    const RgbLanes most = rgbOf(1.f - airReflectance);
    if (anyGreater(lobeSum + sums.diffuse, most)) { // a channel may be brighter than any band (gold's red is 1.04)
        const RgbLanes scale = lower(rgbOf(1.f), most / (lobeSum + sums.diffuse));
        for (int k = 0; k <= present.count; ++k) {
            output.lobes[k] *= scale;
        }
        lobeSum *= scale;
        sums.diffuse *= scale;
    }
    store(sums.diffuse, out.diffuse);

    // The air's reflection has the roughness of the topmost film; as that film fades out, of the one below it.
    float left = 1.f;
    int next = layerTotal; // lobes from here on are written
    Lobe* const lobes = out.lobes.data();
    for (int k = present.count - 1; k >= -1; --k) {
        const int index = k >= 0 ? present.index[k] : 0;
        while (--next > index) {
            lobes[next] = darkLobes_[next];
        }
        const float share = k >= 0 ? left * present.weight[k] : left;
        left -= share;
        const float air = share * airReflectance;
        const float airAtEdge = share * airEdge;
        const RgbLanes below = output.lobes[k + 1];
        RgbLanes edge = below;
        if (k < 0 && input.wantEdge) {
            const RgbLanes room = most - sums.diffuse - (lobeSum - below);
            const RgbLanes rising = higher(lower(output.edge, room), below);
            edge = below + (rising - below) * (1.f - airEdge);
        }
        const RgbLanes colour = below + rgbOf(air);
        Lobe& lobe = lobes[index];
        store(colour, lobe.colour);
        store(edge + rgbOf(airAtEdge), lobe.edgeColour);
        lobe.air = air;
        lobe.airEdge = airAtEdge;
        lobe.alpha = layers[index].alpha;
        lobe.roughness = layers[index].roughness;
        sums.add(layers[index], colour, rgbOf(air));
    }
    flatten(sums, airReflectance, out);
}

void StackOptics::evaluatePaper(const Spectrum& metal, const PresentLayers& present, Appearance& out) const {
    KernelInput input;
    input.count = present.count;
    input.base = &metal;
    input.weights = &weights_;
    for (int k = 0; k < present.count; ++k) {
        const Layer& layer = layers_[present.index[k]];
        input.layers[k] = {&layer.optics, &layer.specular, present.thicknessUm[k], 0.f};
    }
    KernelOutput output;
    bestStackKernel().foldPaper(input, output);

    LightSums sums;
    sums.diffuse = clamped01(output.diffuse);
    store(sums.diffuse, out.diffuse);
    std::copy(darkLobes_.begin(), darkLobes_.end(), out.lobes.begin());
    for (int k = -1; k < present.count; ++k) {
        const int index = k >= 0 ? present.index[k] : 0;
        const RgbLanes colour = clamped01(output.lobes[k + 1]);
        store(colour, out.lobes[index].colour);
        store(colour, out.lobes[index].edgeColour);
        sums.add(layers_[index], colour, RgbLanes{});
    }
    const float top = present.count > 0 ? layers_[present.index[present.count - 1]].refractiveIndex : 1.f;
    flatten(sums, normalDielectric(top, 1.f), out);
}

} // namespace patina
