#pragma once
// The inner loop of StackOptics: one stack, all bands at once.

#include "optics/layer_stack.h"

namespace patina {

/// K and S of one band as the kernel wants them.
struct LayerOptics {
    float kappa, scattering, absorption, extinction;

    /// kappa is kept above 1e-6 (K + S): so S / kappa is finite, and what it changes, a white layer that would return
    /// more than 0.999999, cannot be seen.
    static LayerOptics of(double absorption, double scattering);
};

/// What the kernel needs to know of one present layer.
struct KernelLayer {
    const Spectrum* kappa;      ///< sqrt(K (K + 2 S)), above 0 (LayerOptics)
    const Spectrum* scattering; ///< S / kappa
    const Spectrum* absorption; ///< K / kappa
    const Spectrum* extinction; ///< K + S, 1/µm
    float thicknessUm;
    float interfaceAbove; ///< reflectance of the interface with the layer above; 0 for the topmost
};

/// A stack whose absent layers are left out.
struct KernelInput {
    int count;
    KernelLayer layers[StackOptics::maxLayers];
    const Spectrum* base;
    const Spectrum* rgbWeights; ///< three of them
    float k1;                   ///< of the interface with the air, from outside
    float k2;                   ///< from inside
    bool wantEdge;
};

/// Linear Rec.709, not clipped.
struct KernelOutput {
    float diffuse[3];
    float lobes[StackOptics::maxLayers + 1][3]; ///< below the air: [0] the metal, [k] above present layer k - 1
    float edge[3];                              ///< what the metal would reflect were it perfect
};

/// The two loops, built for one width of register.
struct StackKernel {
    /// Kubelka–Munk of the layers over the base; interfaces are left out.
    void (*foldBody)(const KernelInput& input, Spectrum& result);
    /// The default model (docs/optics.md, "Glossy and diffuse").
    void (*foldConserving)(const KernelInput& input, KernelOutput& output);
};

/// The widest build up to `width` numbers in a register that this machine can run. All give the same bits.
StackKernel stackKernel(int width = 16);

} // namespace patina
