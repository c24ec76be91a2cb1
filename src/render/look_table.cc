#include "render/look_table.h"

#include "render/look_kernels.h"

#include <algorithm>
#include <limits>

namespace patina {

using Imath::V3f;

LookTable::LookTable(const StackOptics& optics, std::size_t vertices)
    : model_(optics.model()), lobes_(optics.layerCount() + 1), stride_(3 + std::size_t(valuesPerLobe) * lobes_) {
    // A lobe has its material's width whether or not anything is there.
    Appearance look;
    const std::vector<float> none(std::size_t(optics.layerCount()) + 1, 0.f);
    optics.evaluate(none.data(), look);
    for (const Lobe& lobe : look.lobes)
        shapes_.push_back(LobeShape::of(lobe));
    values_.resize(vertices * stride_);
}

void LookTable::set(std::size_t vertex, const Appearance& look) {
    float* to = values_.data() + vertex * stride_;
    const auto put = [&to](const V3f& colour) {
        *to++ = colour.x;
        *to++ = colour.y;
        *to++ = colour.z;
    };
    put(look.diffuse);
    for (const Lobe& lobe : look.lobes) {
        put(lobe.colour);
        put(lobe.edgeColour);
        *to++ = lobe.air;
        *to++ = lobe.airEdge;
    }
}

void LookTable::pack() {
    const std::size_t vertices = values_.size() / stride_;
    std::vector<int> seen;
    for (int k = 0; k < lobes_; ++k) {
        bool lit = false;
        for (std::size_t v = 0; v < vertices && !lit; ++v) {
            const float* lobe = values_.data() + v * stride_ + 3 + valuesPerLobe * k;
            lit = std::any_of(lobe, lobe + valuesPerLobe, [](float value) { return value > 0.f; });
        }
        if (lit)
            seen.push_back(k);
    }
    if (int(seen.size()) == lobes_)
        return;
    const std::size_t packed = 3 + std::size_t(valuesPerLobe) * seen.size();
    for (std::size_t v = 0; v < vertices; ++v) { // forward: what is written was read before
        const float* from = values_.data() + v * stride_;
        float* to = values_.data() + v * packed;
        std::copy_n(from, 3, to);
        for (std::size_t i = 0; i < seen.size(); ++i)
            std::copy_n(from + 3 + valuesPerLobe * seen[i], valuesPerLobe, to + 3 + valuesPerLobe * i);
    }
    std::vector<LobeShape> shapes;
    for (const int k : seen)
        shapes.push_back(shapes_[std::size_t(k)]);
    shapes_ = std::move(shapes);
    lobes_ = int(seen.size());
    stride_ = packed;
    values_.resize(vertices * stride_);
    values_.shrink_to_fit();
}

PatinaBsdf LookTable::bsdf(const Imath::V3i& corners, float u, float v) const {
    const float* a = values_.data() + std::size_t(corners.x) * stride_;
    const float* b = values_.data() + std::size_t(corners.y) * stride_;
    const float* c = values_.data() + std::size_t(corners.z) * stride_;
    const float w = 1.f - u - v;
    const auto mix = [&](std::size_t i) { return w * a[i] + u * b[i] + v * c[i]; };
    PatinaBsdf bsdf(model_, V3f(mix(0), mix(1), mix(2)));
    for (int k = 0; k < lobes_; ++k) {
        const std::size_t i = 3 + std::size_t(valuesPerLobe) * std::size_t(k);
        bsdf.addLobe(shapes_[std::size_t(k)], V3f(mix(i), mix(i + 1), mix(i + 2)),
                     V3f(mix(i + 3), mix(i + 4), mix(i + 5)), mix(i + 6), mix(i + 7));
    }
    bsdf.normalise();
    return bsdf;
}

void LookTable::bsdfs(const std::vector<Imath::V3i>& triangles, const HitBatch& hits, const std::vector<int>& from,
                      std::size_t count, BsdfBatch& into) const {
    if (values_.size() > std::size_t(std::numeric_limits<int>::max())) { // lanes count in single words
        for (std::size_t i = 0; i < count; ++i) {
            const auto hit = std::size_t(from[i]);
            into.set(i, bsdf(triangles[std::size_t(hits.triangle[hit])], hits.u[hit], hits.v[hit]));
        }
        return;
    }
    into.need(lobes_);
    VectorLanes& diffuse = into.diffuse();
    LookLanes lanes{BsdfBatch::padded(count), from.data(),    hits.triangle.data(), hits.u.data(),    hits.v.data(),
                    &triangles[0].x,          values_.data(), int(stride_),         diffuse.x.data(), diffuse.y.data(),
                    diffuse.z.data(),         into.meanAir(), into.leastAir()};
    mixDiffuseLanes(lanes);
    for (int k = 0; k < lobes_; ++k)
        mixLobeLanes({lanes, 3 + valuesPerLobe * k, shapes_[std::size_t(k)], into.rows(k)});
    into.normalise(model_, count);
}

} // namespace patina
