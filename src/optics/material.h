#pragma once
// What a layer or the base metal is made of.

#include "optics/spectrum.h"

#include <Imath/ImathVec.h>

#include <string>

namespace patina {

/// A material as `data/materials/NAME.toml` describes it (docs/optics.md has the file's keys).
/// Films are described by absorption and scattering, metals by their reflectance.
struct Material {
    std::string name;        ///< the word of the scripts, "cuprite_2"
    std::string title;       ///< for people
    std::string source;      ///< where the numbers come from
    bool isMetal = false;    ///< opaque, reflects like a mirror; may lie at the bottom of a stack
    bool isEstimate = false; ///< some number is an estimate; `source` says which and from what

    Spectrum absorption;  ///< K, 1/µm of solid material; 0 for metals
    Spectrum scattering;  ///< S, 1/µm; 0 for metals
    Spectrum reflectance; ///< metals: at normal incidence, in air. Films: of an opaque layer, without the air interface
    FineSpectrum fineAbsorption{}; ///< the same three every 5 nm
    FineSpectrum fineScattering{};
    FineSpectrum fineReflectance{};

    bool hasIndex = false; ///< the complex index of the solid is known: a thin film of it interferes (thin_film.h)
    Spectrum indexN;       ///< n
    Spectrum indexK;       ///< k; of films it follows from K
    FineSpectrum fineN{};  ///< both every 5 nm
    FineSpectrum fineK{};

    Imath::V3f specularColour{0.04f}; ///< of its interface with air at normal incidence, linear Rec.709, 0…1
    float roughness = 0.3f;           ///< r of the paper's (N·H)^(1/r), above 0, at most 1
    float refractiveIndex = 1.5f;     ///< of its interface, at least 1 (an effective one where the surface is porous)

    float hardness = 1.f;       ///< erosion spends thickness times hardness
    float density = 1.f;        ///< solid fraction of the layer, above 0, at most 1
    float densityKgPerM3 = 0.f; ///< of the solid; of mixtures the parts' mean by volume; 0 where it is not known

    Imath::V3f swatch{0.5f}; ///< colour of an opaque layer seen in air (interface included), linear Rec.709, 0…1
};

/// Width of the GGX distribution that is as high at its top as the paper's (N·H)^(1/r):
/// alpha = sqrt(2 / (1/r + 2)).
float ggxAlpha(float paperRoughness);

} // namespace patina
