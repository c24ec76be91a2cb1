#pragma once
// The inner loop of StackOptics: one stack, all bands at once.

#include "optics/layer_optics.h"
#include "optics/layer_stack.h"
#include "optics/rgb_lanes.h"

namespace patina {

/// What the kernel needs to know of one present layer.
struct KernelLayer {
    const LayerSpectra* optics;
    const Spectrum* specular; ///< of the lobe at its upper face; only `paper` reads it
    float thicknessUm;
    float interfaceAbove; ///< reflectance of the interface with the layer above; 0 for the topmost
};

/// A stack whose absent layers are left out.
struct KernelInput {
    int count;
    KernelLayer layers[StackOptics::maxLayers];
    const Spectrum* base;
    const ChannelWeights* weights;
    float k1; ///< of the interface with the air, from outside
    float k2; ///< from inside
    bool wantEdge;
};

/// Linear light of the weights' colour space; the fourth of each is 0. The default model's is 0 or more: spectra below
/// 1 that leave the gamut are clipped.
struct KernelOutput {
    RgbLanes diffuse;
    RgbLanes lobes[StackOptics::maxLayers + 1]; ///< below the air: [0] the metal, [k] above present layer k - 1
    RgbLanes lobeSum;                           ///< the default model's lobes, all together
    RgbLanes edge;                              ///< what the metal would reflect were it perfect
};

/// The loops, built for one width of register.
struct StackKernel {
    /// Kubelka–Munk of the layers over the base; interfaces are left out.
    void (*foldBody)(const KernelInput& input, Spectrum& result);
    /// The default model (docs/optics.md, "Glossy and diffuse").
    void (*foldConserving)(const KernelInput& input, KernelOutput& output);
    /// The paper's model: Kubelka–Munk as the diffuse part, lobes by the transmittance of what lies above.
    void (*foldPaper)(const KernelInput& input, KernelOutput& output);
};

/// Weights of the bands in red, green and blue, arranged as the kernel wants them.
ChannelWeights channelWeights(const std::array<Spectrum, 3>& rgb);

/// The widest build up to `width` numbers in a register that this machine can run. All give the same bits.
StackKernel stackKernel(int width);
/// The widest of all.
const StackKernel& bestStackKernel();

} // namespace patina
