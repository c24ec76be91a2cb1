#pragma once
// The BRDF of a weathered point, for renderers: evaluate, sample, pdf.

#include "optics/layer_stack.h"
#include "optics/microfacet.h"

#include <Imath/ImathVec.h>

namespace patina {

/// A direction drawn in proportion to a BSDF.
struct BsdfSample {
    Imath::V3f wi{0.f};     ///< towards the light, local frame
    float pdf = 0.f;        ///< per steradian; 0 when nothing was drawn
    Imath::V3f weight{0.f}; ///< f · cos / pdf
};

/// f and the density of drawing that direction.
struct BsdfValue {
    Imath::V3f value{0.f}; ///< 1/sr, without the cosine
    float pdf = 0.f;       ///< per steradian
};

/// The width of a lobe, and what follows from it alone.
struct LobeShape {
    float alpha = 0.3f;
    float exponent = 3.f; ///< 1/r of the paper
    LobeAlbedo mean;      ///< meanLobeAlbedo()
    float least = 1.f;    ///< leastLobeAlbedo()
    AlbedoPlace row;      ///< of this width in the table of albedos

    static LobeShape of(const Lobe& lobe);
};

/// Local frame: z is the normal, directions are unit vectors away from the surface. Reciprocal; light from below and to
/// below is 0. With OpticsModel::energyConserving no direction gets back more than it sends (docs/optics.md).
class PatinaBsdf {
  public:
    explicit PatinaBsdf(const Appearance& appearance);
    /// Piece by piece: addLobe() for each of an appearance's lobes, then normalise(), before anything else is asked.
    PatinaBsdf(OpticsModel model, const Imath::V3f& diffuse) : diffuse_(diffuse), model_(model) {}
    void addLobe(const LobeShape& shape, const Imath::V3f& colour, const Imath::V3f& edgeColour, float air,
                 float airEdge);
    void normalise();

    /// Copies the lobes that are there alone: most have one to five of the 65 that a stack may have.
    PatinaBsdf(const PatinaBsdf& other);
    PatinaBsdf& operator=(const PatinaBsdf& other);

    /// f(wo, wi), 1/sr, without the cosine. Linear Rec.709.
    Imath::V3f evaluate(const Imath::V3f& wo, const Imath::V3f& wi) const;
    /// \param u  three uniforms in [0, 1).
    BsdfSample sample(const Imath::V3f& wo, const Imath::V3f& u) const;
    /// Density of sample(), 1/sr.
    float pdf(const Imath::V3f& wo, const Imath::V3f& wi) const;

  private:
    friend class SeenBsdf;
    friend class BsdfBatch;

    static constexpr int maxLobes = StackOptics::maxLayers + 1;

    struct GlossyLobe {
        Imath::V3f body;     ///< reflected below the air interface, at normal incidence
        Imath::V3f bodyEdge; ///< at grazing incidence
        float air;
        float airEdge;
        float alpha;
        float exponent; ///< 1/r
        AlbedoPlace row;
    };

    float passThroughAir(float cosine) const;
    /// How much a part reflects towards wo, roughly: the chance of sampling it.
    float lobeChance(int lobe, float schlick) const;

    Imath::V3f diffuse_;
    OpticsModel model_;
    int lobeCount_ = 0;
    float meanAir_ = 0.f;           ///< what the air reflects of light from everywhere
    float leastAir_ = 0.f;          ///< at the angle at which it reflects least
    float diffuseNormaliser_ = 1.f; ///< makes the diffuse part's albedo at its brightest angle equal to `diffuse`
    float passNormaliser_ = 1.f;    ///< the same for what the air lets through to buried interfaces
    GlossyLobe lobes_[maxLobes];
};

/// A BSDF as seen from one direction: what depends on that direction alone is worked out once, for renderers that ask
/// about many others. Valid while the BSDF is.
class SeenBsdf {
  public:
    SeenBsdf(const PatinaBsdf& bsdf, const Imath::V3f& wo);

    BsdfValue evaluate(const Imath::V3f& wi) const;
    /// \param u  three uniforms in [0, 1).
    BsdfSample sample(const Imath::V3f& u) const;

  private:
    BsdfValue evaluateConserving(const Imath::V3f& wi) const;
    BsdfValue evaluatePaper(const Imath::V3f& wi) const;

    // Of each lobe.
    struct LobeView {
        float chance;  ///< of drawing from it, times `total_`
        float slope;   ///< sqrt(cos² + alpha² sin²) of wo
        float density; ///< times D(h) it is the lobe's part of the density
    };

    const PatinaBsdf& bsdf_;
    Imath::V3f wo_;
    float pass_ = 1.f;        ///< through the air, towards wo
    float diffuseChance_ = 0; ///< times `total_`
    float total_ = 0.f;
    LobeView lobes_[PatinaBsdf::maxLobes];
};

} // namespace patina
