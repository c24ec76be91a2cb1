#pragma once
// The look of a stack of layers on a metal, from their thicknesses.

#include "optics/colour.h"
#include "optics/layer_optics.h"
#include "optics/material.h"
#include "optics/thin_film.h"

#include <Imath/ImathVec.h>

#include <array>
#include <vector>

namespace patina {

/// How the glossy and the diffuse part share the light (docs/optics.md derives both).
enum class OpticsModel {
    energyConserving, ///< what films scatter is taken from what they let through; diffuse + lobes <= 1
    paper,            ///< Dorsey & Hanrahan 1996 §4.3 to the letter; may return more than it receives
};

/// What a stack's light is computed with besides the model.
struct StackFeatures {
    bool thinFilm = false; ///< a film below 0.15 µm directly on the metal shows interference colours
    ColourSpace colourSpace = ColourSpace::rec709;
};

/// Glossy reflection at one interface. Between normal and grazing incidence the colour goes by Schlick's (1 - c)^5.
struct Lobe {
    Imath::V3f colour{0.f};     ///< specular colour at normal incidence, attenuated by what lies above
    Imath::V3f edgeColour{0.f}; ///< the same at grazing incidence, not yet dimmed by what the air interface keeps away
    float air = 0.f;        ///< the part of `colour` that the interface with the air reflects: it lies above all else
    float airEdge = 0.f;    ///< the same of `edgeColour`
    float alpha = 0.3f;     ///< width of the GGX distribution
    float roughness = 0.3f; ///< r of the paper
};

/// The reflection of one point, ready for a BSDF or for maps. Linear light of the stack's colour space.
struct Appearance {
    OpticsModel model = OpticsModel::energyConserving;
    Imath::V3f diffuse{0.f}; ///< diffuse reflectance at normal incidence, 0…1
    /// lobes[i] belongs to the interface above materials[i], base metal first; black where the layer is absent or
    /// hidden, or where the next layer is of the same material.
    std::vector<Lobe> lobes;

    /// The same flattened to one lobe, for renderers that have one: metals reflect `baseColour`, the rest scatters it.
    Imath::V3f baseColour{0.f};
    float metallic = 0.f;           ///< 0…1
    float flattenedRoughness = 0.f; ///< square root of the GGX alpha, as such renderers have it; 0…1
    float specular = 0.f;           ///< reflectance of the air interface / 0.08, as such renderers have it; 0…1
};

/// Optics of one order of materials; thicknesses vary from point to point.
class StackOptics {
  public:
    using Model = OpticsModel;
    using Appearance = patina::Appearance;

    /// Most layers a stack may have.
    static constexpr int maxLayers = 64;
    /// A film's interface fades in around this thickness, a quarter of a wave: a thinner one has no surface of its own.
    static constexpr float interfaceThicknessUm = 0.1f;

    /// \param materials  [0] the base metal, then layer 1…n from bottom to top; not null, copied.
    /// \throws RunError when there is no material, or more than maxLayers layers.
    explicit StackOptics(const std::vector<const Material*>& materials, Model model = Model::energyConserving,
                         const StackFeatures& features = {});

    int layerCount() const { return static_cast<int>(layers_.size()) - 1; }
    Model model() const { return model_; }
    const StackFeatures& features() const { return features_; }
    /// The same optics with its results in another colour space.
    StackOptics in(ColourSpace space) const;

    /// \param thicknessUm  one per layer from bottom to top, real micrometres of solid; 0 or less means absent.
    ///                     May be null when there are no layers.
    /// Allocates nothing when `out` was used for this stack before. Safe from any thread.
    void evaluate(const float* thicknessUm, Appearance& out) const;

    /// Kubelka–Munk alone: reflectance per band of the stack over its metal, without the interface with the air.
    Spectrum bodyReflectance(const float* thicknessUm) const;

  private:
    struct Layer {
        LayerSpectra optics;
        Spectrum reflectance; ///< base: of the metal
        Spectrum specular;    ///< specular colour of the paper's lobe
        float refractiveIndex = 1.f;
        float alpha = 0.f;
        float roughness = 0.f;
        bool isMetal = false;
        int kind = 0;      ///< the same number for layers of the same material
        int thinFilm = -1; ///< index into thinFilms_; -1: does not interfere
    };
    struct PresentLayers;
    struct LightSums;

    void setColourSpace(ColourSpace space);
    PresentLayers presentLayers(const float* thicknessUm) const;
    /// Share of the first present layer's look that is interference; `reflectance` is then the metal's under it.
    float interference(const PresentLayers& present, Spectrum& reflectance) const;
    void evaluateOver(const Spectrum& base, const PresentLayers& present, Appearance& out) const;
    void evaluateConserving(const Spectrum& base, const PresentLayers& present, Appearance& out) const;
    void evaluatePaper(const Spectrum& base, const PresentLayers& present, Appearance& out) const;
    void flatten(const LightSums& sums, float airReflectance, Appearance& out) const;

    std::vector<Layer> layers_; ///< [0] is the base
    std::vector<ThinFilmTable> thinFilms_;
    std::vector<Lobe> darkLobes_;      ///< of layers that are absent: width and roughness, no colour
    std::vector<float> interfaces_;    ///< reflectance between two layers: [below · layers + above]
    std::array<Spectrum, 4> weights_;  ///< of the bands in the channels (ChannelWeights)
    std::array<float, 4> luminance_{}; ///< Y of each channel
    StackFeatures features_;
    std::array<float, 65> internalReflectance_; ///< Saunderson's k2 for n = 1 … 3
    Model model_;
};

} // namespace patina
