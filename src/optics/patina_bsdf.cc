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

} // namespace

LobeShape LobeShape::of(const Lobe& lobe) {
    LobeShape shape;
    shape.alpha = std::clamp(lobe.alpha, sharpestAlpha, 1.f);
    shape.exponent = 1.f / std::max(lobe.roughness, 1e-4f);
    shape.mean = meanLobeAlbedo(shape.alpha);
    shape.least = leastLobeAlbedo(shape.alpha);
    shape.row = albedoRow(shape.alpha);
    return shape;
}

PatinaBsdf::PatinaBsdf(const Appearance& appearance) : PatinaBsdf(appearance.model, appearance.diffuse) {
    for (const Lobe& lobe : appearance.lobes) {
        addLobe(LobeShape::of(lobe), lobe.colour, lobe.edgeColour, lobe.air, lobe.airEdge);
    }
    normalise();
}

void PatinaBsdf::addLobe(const LobeShape& shape, const V3f& colour, const V3f& edgeColour, float air, float airEdge) {
    const bool black = brightest(colour) <= 0.f && brightest(edgeColour) <= 0.f;
    if (black || lobeCount_ == maxLobes) {
        return;
    }
    GlossyLobe& glossy = lobes_[lobeCount_++];
    glossy.body = colour - V3f(air);
    glossy.bodyEdge = edgeColour - V3f(airEdge);
    glossy.air = air;
    glossy.airEdge = airEdge;
    glossy.alpha = shape.alpha;
    glossy.exponent = shape.exponent;
    glossy.row = shape.row;
    if (airEdge > 0.f) {
        meanAir_ += air * shape.mean.flat + airEdge * shape.mean.rising;
        leastAir_ += air * shape.least;
    }
}

void PatinaBsdf::normalise() {
    // The air lets most through where it reflects least: at that angle the rest is as bright as `appearance` says.
    const float most = 1.f - leastAir_;
    passNormaliser_ = 1.f / (most * most);
    diffuseNormaliser_ = 1.f / (most * (1.f - meanAir_));
}

PatinaBsdf::PatinaBsdf(const PatinaBsdf& other)
    : diffuse_(other.diffuse_), model_(other.model_), lobeCount_(other.lobeCount_), meanAir_(other.meanAir_),
      leastAir_(other.leastAir_), diffuseNormaliser_(other.diffuseNormaliser_), passNormaliser_(other.passNormaliser_) {
    std::copy(other.lobes_, other.lobes_ + other.lobeCount_, lobes_);
}

PatinaBsdf& PatinaBsdf::operator=(const PatinaBsdf& other) {
    if (this != &other) {
        diffuse_ = other.diffuse_;
        model_ = other.model_;
        lobeCount_ = other.lobeCount_;
        meanAir_ = other.meanAir_;
        leastAir_ = other.leastAir_;
        diffuseNormaliser_ = other.diffuseNormaliser_;
        passNormaliser_ = other.passNormaliser_;
        std::copy(other.lobes_, other.lobes_ + other.lobeCount_, lobes_);
    }
    return *this;
}

float PatinaBsdf::passThroughAir(float cosine) const {
    if (meanAir_ == 0.f) {
        return 1.f;
    }
    float reflected = 0.f;
    const AlbedoPlace column = albedoColumn(cosine);
    for (int k = 0; k < lobeCount_; ++k) {
        if (lobes_[k].airEdge > 0.f) {
            const LobeAlbedo albedo = lobeAlbedo(column, lobes_[k].row);
            reflected += lobes_[k].air * albedo.flat + lobes_[k].airEdge * albedo.rising;
        }
    }
    return std::max(1.f - reflected, 0.f);
}

float PatinaBsdf::lobeChance(int lobe, float schlick) const {
    const GlossyLobe& part = lobes_[lobe];
    return brightest(part.body + (part.bodyEdge - part.body) * schlick) + part.air +
           (part.airEdge - part.air) * schlick;
}

V3f PatinaBsdf::evaluate(const V3f& wo, const V3f& wi) const {
    return SeenBsdf(*this, wo).evaluate(wi).value;
}

BsdfSample PatinaBsdf::sample(const V3f& wo, const V3f& u) const {
    return SeenBsdf(*this, wo).sample(u);
}

float PatinaBsdf::pdf(const V3f& wo, const V3f& wi) const {
    return SeenBsdf(*this, wo).evaluate(wi).pdf;
}

SeenBsdf::SeenBsdf(const PatinaBsdf& bsdf, const V3f& wo) : bsdf_(bsdf), wo_(wo) {
    if (!(wo.z > 0.f)) {
        return;
    }
    const float s = schlickWeight(wo.z);
    diffuseChance_ = brightest(bsdf.diffuse_);
    total_ = diffuseChance_;
    const float sine2 = std::max(1.f - wo.z * wo.z, 0.f);
    for (int k = 0; k < bsdf.lobeCount_; ++k) {
        LobeView& view = lobes_[k];
        const float alpha = bsdf.lobes_[k].alpha;
        view.chance = bsdf.lobeChance(k, s);
        total_ += view.chance;
        // Smith's masking is 2 cos / (cos + slope), and the density masking · D / (4 cos).
        view.slope = std::sqrt(wo.z * wo.z + alpha * alpha * sine2);
        view.density = 0.5f * view.chance / (wo.z + view.slope);
    }
    if (bsdf.model_ != OpticsModel::paper) {
        pass_ = bsdf.passThroughAir(wo.z);
    }
}

BsdfValue SeenBsdf::evaluate(const V3f& wi) const {
    if (!(wo_.z > 0.f) || !(wi.z > 0.f)) {
        return {};
    }
    BsdfValue result = bsdf_.model_ == OpticsModel::paper ? evaluatePaper(wi) : evaluateConserving(wi);
    result.pdf = total_ > 0.f ? result.pdf / total_ : 0.f;
    return result;
}

BsdfValue SeenBsdf::evaluateConserving(const V3f& wi) const {
    // |wo + wi| / 2 is the cosine to the half vector; unlike wo·h it has the same bits when wo and wi change places.
    const V3f sum = wo_ + wi;
    const float twiceCosine = sum.length();
    if (!(twiceCosine > 0.f)) {
        return {};
    }
    const V3f half = sum / twiceCosine;
    const float s = schlickWeight(0.5f * twiceCosine);
    const float pass = pass_ * bsdf_.passThroughAir(wi.z);
    const float passBody = pass * bsdf_.passNormaliser_;
    const float sine2 = std::max(1.f - wi.z * wi.z, 0.f);
    BsdfValue f{bsdf_.diffuse_ * (pass * bsdf_.diffuseNormaliser_ / pi), diffuseChance_ * wi.z / pi};
    for (int k = 0; k < bsdf_.lobeCount_; ++k) {
        const auto& lobe = bsdf_.lobes_[k];
        const LobeView& view = lobes_[k];
        const float d = ggxDistribution(half, lobe.alpha);
        f.pdf += view.density * d;
        // smithVisibility(), with wo's part known.
        const float slope = std::sqrt(wi.z * wi.z + lobe.alpha * lobe.alpha * sine2);
        const float facets = d * 0.5f / std::max(wi.z * view.slope + wo_.z * slope, 1e-9f);
        const float air = lobe.air + (lobe.airEdge - lobe.air) * s;
        f.value += ((lobe.body + (lobe.bodyEdge - lobe.body) * s) * passBody + V3f(air)) * facets;
    }
    return f;
}

// The paper's lobe as it is printed: C (N·H)^(1/r), neither normalised nor shadowed.
BsdfValue SeenBsdf::evaluatePaper(const V3f& wi) const {
    const V3f half = (wo_ + wi).normalized();
    BsdfValue f{bsdf_.diffuse_ / pi, diffuseChance_ * wi.z / pi};
    for (int k = 0; k < bsdf_.lobeCount_; ++k) {
        const auto& lobe = bsdf_.lobes_[k];
        const float shape = std::pow(half.z, lobe.exponent);
        f.value += lobe.body * shape;
        f.pdf += lobes_[k].chance * (lobe.exponent + 1.f) * shape / (8.f * pi * std::max(wo_.dot(half), 1e-9f));
    }
    return f;
}

BsdfSample SeenBsdf::sample(const V3f& u) const {
    BsdfSample result;
    if (!(total_ > 0.f)) {
        return result;
    }
    float choice = u.z * total_ - diffuseChance_;
    if (choice < 0.f || bsdf_.lobeCount_ == 0) {
        const float radius = std::sqrt(u.x);
        const CirclePoint direction = circlePoint(u.y);
        result.wi = V3f(radius * direction.cosine, radius * direction.sine, std::sqrt(std::max(0.f, 1.f - u.x)));
    } else {
        int chosen = 0;
        while (chosen + 1 < bsdf_.lobeCount_ && choice >= lobes_[chosen].chance) {
            choice -= lobes_[chosen].chance;
            ++chosen;
        }
        const auto& lobe = bsdf_.lobes_[chosen];
        V3f half;
        if (bsdf_.model_ == OpticsModel::paper) {
            const float cosine = std::pow(1.f - u.x, 1.f / (lobe.exponent + 1.f));
            const float sine = std::sqrt(std::max(0.f, 1.f - cosine * cosine));
            const CirclePoint direction = circlePoint(u.y);
            half = V3f(sine * direction.cosine, sine * direction.sine, cosine);
        } else {
            half = sampleVisibleNormal(wo_, lobe.alpha, u.x, u.y);
        }
        result.wi = 2.f * wo_.dot(half) * half - wo_;
    }
    const BsdfValue here = evaluate(result.wi);
    result.pdf = here.pdf;
    if (result.pdf > 0.f) {
        result.weight = here.value * (result.wi.z / result.pdf);
    }
    return result;
}

} // namespace patina
