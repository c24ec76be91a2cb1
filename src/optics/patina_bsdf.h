#pragma once
// The BRDF of a weathered point, for renderers: evaluate, sample, pdf.

#include "optics/layer_stack.h"

#include <Imath/ImathVec.h>

namespace patina {

/// A direction drawn in proportion to a BSDF.
struct BsdfSample {
    Imath::V3f wi{0.f};     ///< towards the light, local frame
    float pdf = 0.f;        ///< per steradian; 0 when nothing was drawn
    Imath::V3f weight{0.f}; ///< f · cos / pdf
};

/// Local frame: z is the normal, directions are unit vectors away from the surface. Reciprocal; light from below and to
/// below is 0. With OpticsModel::energyConserving no direction gets back more than it sends (docs/optics.md).
class PatinaBsdf {
  public:
    explicit PatinaBsdf(const Appearance& appearance);

    /// f(wo, wi), 1/sr, without the cosine. Linear Rec.709.
    Imath::V3f evaluate(const Imath::V3f& wo, const Imath::V3f& wi) const;
    /// \param u  three uniforms in [0, 1).
    BsdfSample sample(const Imath::V3f& wo, const Imath::V3f& u) const;
    /// Density of sample(), 1/sr.
    float pdf(const Imath::V3f& wo, const Imath::V3f& wi) const;

  private:
    static constexpr int maxLobes = StackOptics::maxLayers + 1;

    struct GlossyLobe {
        Imath::V3f body;     ///< reflected below the air interface, at normal incidence
        Imath::V3f bodyEdge; ///< at grazing incidence
        float air;
        float airEdge;
        float alpha;
        float exponent; ///< 1/r
    };

    float passThroughAir(float cosine) const;
    float lobeChance(int lobe, float schlick) const;
    Imath::V3f evaluateConserving(const Imath::V3f& wo, const Imath::V3f& wi) const;
    Imath::V3f evaluatePaper(const Imath::V3f& wo, const Imath::V3f& wi) const;

    Imath::V3f diffuse_;
    OpticsModel model_;
    GlossyLobe lobes_[maxLobes];
    int lobeCount_ = 0;
    float diffuseNormaliser_ = 1.f; ///< makes the diffuse part's albedo at its brightest angle equal to `diffuse`
    float passNormaliser_ = 1.f;    ///< the same for what the air lets through to buried interfaces
};

} // namespace patina
