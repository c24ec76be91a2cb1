#include "optics/patina_bsdf.h"

#include "optics/microfacet.h"

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

using Imath::V3f;

constexpr float pi = 3.14159265358979f;
/// Sharper than this is a mirror to any picture, and too sharp for single precision.
constexpr float sharpestAlpha = 0.005f;

float brightest(const V3f& colour) {
    return std::max({colour.x, colour.y, colour.z, 0.f});
}

bool isBlack(const Lobe& lobe) {
    return brightest(lobe.colour) <= 0.f && brightest(lobe.edgeColour) <= 0.f;
}

} // namespace

PatinaBsdf::PatinaBsdf(const Appearance& appearance) : diffuse_(appearance.diffuse), model_(appearance.model) {
    float meanAir = 0.f;
    float leastAir = 0.f;
    for (const Lobe& lobe : appearance.lobes) {
        if (isBlack(lobe) || lobeCount_ == maxLobes) {
            continue;
        }
        GlossyLobe& glossy = lobes_[lobeCount_++];
        glossy.body = lobe.colour - V3f(lobe.air);
        glossy.bodyEdge = lobe.edgeColour - V3f(lobe.airEdge);
        glossy.air = lobe.air;
        glossy.airEdge = lobe.airEdge;
        glossy.alpha = std::clamp(lobe.alpha, sharpestAlpha, 1.f);
        glossy.exponent = 1.f / std::max(lobe.roughness, 1e-4f);
        if (glossy.airEdge > 0.f) {
            const LobeAlbedo mean = meanLobeAlbedo(glossy.alpha);
            meanAir += glossy.air * mean.flat + glossy.airEdge * mean.rising;
            leastAir += glossy.air * leastLobeAlbedo(glossy.alpha);
        }
    }
    // The air lets most through where it reflects least: at that angle the rest is as bright as `appearance` says.
    const float most = 1.f - leastAir;
    passNormaliser_ = 1.f / (most * most);
    diffuseNormaliser_ = 1.f / (most * (1.f - meanAir));
}

float PatinaBsdf::passThroughAir(float cosine) const {
    float reflected = 0.f;
    for (int k = 0; k < lobeCount_; ++k) {
        if (lobes_[k].airEdge > 0.f) {
            const LobeAlbedo albedo = lobeAlbedo(cosine, lobes_[k].alpha);
            reflected += lobes_[k].air * albedo.flat + lobes_[k].airEdge * albedo.rising;
        }
    }
    return std::max(1.f - reflected, 0.f);
}

V3f PatinaBsdf::evaluate(const V3f& wo, const V3f& wi) const {
    if (!(wo.z > 0.f) || !(wi.z > 0.f)) {
        return V3f(0.f);
    }
    return model_ == OpticsModel::paper ? evaluatePaper(wo, wi) : evaluateConserving(wo, wi);
}

V3f PatinaBsdf::evaluateConserving(const V3f& wo, const V3f& wi) const {
    // |wo + wi| / 2 is the cosine to the half vector; unlike wo·h it has the same bits when wo and wi change places.
    const V3f sum = wo + wi;
    const float twiceCosine = sum.length();
    if (!(twiceCosine > 0.f)) {
        return V3f(0.f);
    }
    const V3f half = sum / twiceCosine;
    const float s = schlickWeight(0.5f * twiceCosine);
    const float pass = passThroughAir(wo.z) * passThroughAir(wi.z);
    V3f f = diffuse_ * (pass * diffuseNormaliser_ / pi);
    for (int k = 0; k < lobeCount_; ++k) {
        const GlossyLobe& lobe = lobes_[k];
        const V3f body = (lobe.body + (lobe.bodyEdge - lobe.body) * s) * (pass * passNormaliser_);
        const float air = lobe.air + (lobe.airEdge - lobe.air) * s;
        f += (body + V3f(air)) * (ggxDistribution(half, lobe.alpha) * smithVisibility(wo, wi, lobe.alpha));
    }
    return f;
}

// The paper's lobe as it is printed: C (N·H)^(1/r), neither normalised nor shadowed.
V3f PatinaBsdf::evaluatePaper(const V3f& wo, const V3f& wi) const {
    const V3f half = (wo + wi).normalized();
    V3f f = diffuse_ / pi;
    for (int k = 0; k < lobeCount_; ++k) {
        f += lobes_[k].body * std::pow(half.z, lobes_[k].exponent);
    }
    return f;
}

/// How much a part reflects towards wo, roughly: the chance of sampling it.
float PatinaBsdf::lobeChance(int lobe, float schlick) const {
    const GlossyLobe& part = lobes_[lobe];
    return brightest(part.body + (part.bodyEdge - part.body) * schlick) + part.air +
           (part.airEdge - part.air) * schlick;
}

BsdfSample PatinaBsdf::sample(const V3f& wo, const V3f& u) const {
    BsdfSample result;
    if (!(wo.z > 0.f)) {
        return result;
    }
    const float s = schlickWeight(wo.z);
    float total = brightest(diffuse_);
    for (int k = 0; k < lobeCount_; ++k) {
        total += lobeChance(k, s);
    }
    if (!(total > 0.f)) {
        return result;
    }
    float choice = u.z * total - brightest(diffuse_);
    if (choice < 0.f || lobeCount_ == 0) {
        const float radius = std::sqrt(u.x);
        const float phi = 2.f * pi * u.y;
        result.wi = V3f(radius * std::cos(phi), radius * std::sin(phi), std::sqrt(std::max(0.f, 1.f - u.x)));
    } else {
        int chosen = 0;
        while (chosen + 1 < lobeCount_ && choice >= lobeChance(chosen, s)) {
            choice -= lobeChance(chosen, s);
            ++chosen;
        }
        V3f half;
        if (model_ == OpticsModel::paper) {
            const float cosine = std::pow(1.f - u.x, 1.f / (lobes_[chosen].exponent + 1.f));
            const float sine = std::sqrt(std::max(0.f, 1.f - cosine * cosine));
            const float phi = 2.f * pi * u.y;
            half = V3f(sine * std::cos(phi), sine * std::sin(phi), cosine);
        } else {
            half = sampleVisibleNormal(wo, lobes_[chosen].alpha, u.x, u.y);
        }
        result.wi = 2.f * wo.dot(half) * half - wo;
    }
    result.pdf = pdf(wo, result.wi);
    if (result.pdf > 0.f) {
        result.weight = evaluate(wo, result.wi) * (result.wi.z / result.pdf);
    }
    return result;
}

float PatinaBsdf::pdf(const V3f& wo, const V3f& wi) const {
    if (!(wo.z > 0.f) || !(wi.z > 0.f)) {
        return 0.f;
    }
    const V3f half = (wo + wi).normalized();
    const float s = schlickWeight(wo.z);
    float total = brightest(diffuse_);
    float density = total * wi.z / pi;
    for (int k = 0; k < lobeCount_; ++k) {
        const GlossyLobe& lobe = lobes_[k];
        const float chance = lobeChance(k, s);
        total += chance;
        if (model_ == OpticsModel::paper) {
            density += chance * (lobe.exponent + 1.f) * std::pow(half.z, lobe.exponent) /
                       (8.f * pi * std::max(wo.dot(half), 1e-9f));
        } else {
            density += chance * smithMasking(wo, lobe.alpha) * ggxDistribution(half, lobe.alpha) / (4.f * wo.z);
        }
    }
    return total > 0.f ? density / total : 0.f;
}

} // namespace patina
