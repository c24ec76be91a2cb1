#include "optics/bsdf_batch.h"

#include "optics/bsdf_kernels.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V3f;

namespace {

constexpr float pi = 3.14159265358979f;

} // namespace

void BsdfBatch::begin(std::size_t count) {
    count_ = count;
    anyAir_ = anyPaper_ = false;
    const std::size_t lanes = padded(count);
    if (lanes > stride_) {
        stride_ = lanes;
        numbers_.clear();
        rowBelow_.clear();
        diffuse_.resize(lanes);
        wo_.resize(lanes);
        for (auto* of :
             {&meanAir_, &leastAir_, &diffuseNormaliser_, &passNormaliser_, &pass_, &diffuseChance_, &total_})
            of->resize(lanes);
        paper_.resize(lanes);
    }
    lobes_ = 0;
}

void BsdfBatch::need(int lobes) {
    if (lobes <= lobes_)
        return;
    if (const std::size_t needed = std::size_t(lobes) * lobeNumbers * stride_; numbers_.size() < needed) {
        numbers_.resize(needed, 0.f);
        rowBelow_.resize(std::size_t(lobes) * stride_, 0);
    }
    for (int k = lobes_; k < lobes; ++k) {
        for (int n = 0; n < lobeAlpha; ++n)
            std::fill_n(field(k, n), padded(count_), 0.f);
        std::fill_n(field(k, lobeAlpha), padded(count_), 1.f);
    }
    lobes_ = lobes;
}

void BsdfBatch::set(std::size_t lane, const PatinaBsdf& bsdf) {
    need(bsdf.lobeCount_);
    diffuse_.set(lane, bsdf.diffuse_);
    meanAir_[lane] = bsdf.meanAir_;
    diffuseNormaliser_[lane] = bsdf.diffuseNormaliser_;
    passNormaliser_[lane] = bsdf.passNormaliser_;
    paper_[lane] = bsdf.model_ == OpticsModel::paper;
    anyPaper_ = anyPaper_ || paper_[lane];
    anyAir_ = anyAir_ || bsdf.meanAir_ != 0.f;
    for (int k = 0; k < lobes_; ++k) {
        const bool there = k < bsdf.lobeCount_;
        const PatinaBsdf::GlossyLobe lobe =
            there ? bsdf.lobes_[k] : PatinaBsdf::GlossyLobe{V3f(0.f), V3f(0.f), 0, 0, 1, 1, {}};
        const LobeRows to = rows(k);
        to.bodyX[lane] = lobe.body.x, to.bodyY[lane] = lobe.body.y, to.bodyZ[lane] = lobe.body.z;
        to.bodyEdgeX[lane] = lobe.bodyEdge.x, to.bodyEdgeY[lane] = lobe.bodyEdge.y,
        to.bodyEdgeZ[lane] = lobe.bodyEdge.z;
        to.air[lane] = lobe.air, to.airEdge[lane] = lobe.airEdge;
        to.alpha[lane] = lobe.alpha, to.exponent[lane] = lobe.exponent;
        to.rowWeight[lane] = lobe.row.weight, to.rowBelow[lane] = lobe.row.below;
    }
}

BsdfBatch::LobeRows BsdfBatch::rows(int k) {
    return {field(k, bodyX),        field(k, bodyY),         field(k, bodyZ),
            field(k, bodyEdgeX),    field(k, bodyEdgeY),     field(k, bodyEdgeZ),
            field(k, lobeAir),      field(k, lobeAirEdge),   field(k, lobeAlpha),
            field(k, lobeExponent), field(k, lobeRowWeight), rowBelow_.data() + std::size_t(k) * stride_};
}

void BsdfBatch::normalise(OpticsModel model, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const float most = 1.f - leastAir_[i];
        passNormaliser_[i] = 1.f / (most * most);
        diffuseNormaliser_[i] = 1.f / (most * (1.f - meanAir_[i]));
        anyAir_ = anyAir_ || meanAir_[i] != 0.f;
    }
    const bool paper = model == OpticsModel::paper;
    anyPaper_ = anyPaper_ || paper;
    std::fill_n(paper_.begin(), count, char(paper));
}

std::size_t BsdfBatch::place(int lobe, int number) const {
    return (std::size_t(lobe) * lobeNumbers + std::size_t(number)) * stride_;
}

BsdfLanes BsdfBatch::lanes() {
    return {padded(count_),
            stride_,
            lobes_,
            anyAir_,
            numbers_.data(),
            rowBelow_.data(),
            albedoGrid(),
            diffuse_.x.data(),
            diffuse_.y.data(),
            diffuse_.z.data(),
            diffuseNormaliser_.data(),
            passNormaliser_.data(),
            wo_.x.data(),
            wo_.y.data(),
            wo_.z.data(),
            pass_.data(),
            diffuseChance_.data(),
            total_.data()};
}

void BsdfBatch::seenFrom(const VectorLanes& wo) {
    const std::size_t count = padded(count_);
    std::copy_n(wo.x.data(), count, wo_.x.data());
    std::copy_n(wo.y.data(), count, wo_.y.data());
    std::copy_n(wo.z.data(), count, wo_.z.data());
    seeLanes(lanes());
}

void BsdfBatch::evaluate(const VectorLanes& wi, VectorLanes& value, std::vector<float>& pdf) {
    evaluateLanes(
        {lanes(), wi.x.data(), wi.y.data(), wi.z.data(), value.x.data(), value.y.data(), value.z.data(), pdf.data()});
    for (std::size_t i = 0; i < count_ && anyPaper_; ++i)
        if (paper_[i]) {
            const BsdfValue here = evaluatePaper(i, wi[i]);
            value.set(i, here.value);
            pdf[i] = here.pdf;
        }
}

void BsdfBatch::sample(const VectorLanes& u, VectorLanes& wi, VectorLanes& value, std::vector<float>& pdf) {
    sampleLanes({lanes(), u.x.data(), u.y.data(), u.z.data(), wi.x.data(), wi.y.data(), wi.z.data()});
    for (std::size_t i = 0; i < count_ && anyPaper_; ++i)
        if (paper_[i] && total_[i] > 0.f)
            wi.set(i, samplePaper(i, u[i]));
    evaluate(wi, value, pdf);
}

// The paper's lobe: SeenBsdf's evaluatePaper() and sample(), which have no part that lanes could share.
BsdfValue BsdfBatch::evaluatePaper(std::size_t lane, const V3f& wi) {
    const V3f wo = wo_[lane];
    if (!(wo.z > 0.f) || !(wi.z > 0.f))
        return {};
    const V3f half = (wo + wi).normalized();
    BsdfValue f{diffuse_[lane] / pi, diffuseChance_[lane] * wi.z / pi};
    for (int k = 0; k < lobes_; ++k) {
        const float power = field(k, lobeExponent)[lane], shape = std::pow(half.z, power);
        f.value += V3f(field(k, bodyX)[lane], field(k, bodyY)[lane], field(k, bodyZ)[lane]) * shape;
        f.pdf += field(k, lobeChance)[lane] * (power + 1.f) * shape / (8.f * pi * std::max(wo.dot(half), 1e-9f));
    }
    f.pdf = total_[lane] > 0.f ? f.pdf / total_[lane] : 0.f;
    return f;
}

V3f BsdfBatch::samplePaper(std::size_t lane, const V3f& u) {
    float choice = u.z * total_[lane] - diffuseChance_[lane];
    int chosen = -1;
    for (int k = 0; k < lobes_ && choice >= 0.f; ++k)
        if (const float chance = field(k, lobeChance)[lane]; chance > 0.f) {
            chosen = k;
            choice -= chance;
        }
    const CirclePoint around = circlePoint(u.y);
    if (chosen < 0) {
        const float radius = std::sqrt(u.x);
        return {radius * around.cosine, radius * around.sine, std::sqrt(std::max(0.f, 1.f - u.x))};
    }
    const float cosine = std::pow(1.f - u.x, 1.f / (field(chosen, lobeExponent)[lane] + 1.f));
    const float sine = std::sqrt(std::max(0.f, 1.f - cosine * cosine));
    const V3f half(sine * around.cosine, sine * around.sine, cosine), wo = wo_[lane];
    return 2.f * wo.dot(half) * half - wo;
}

} // namespace patina
