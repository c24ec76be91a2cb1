#include "render/stack_shader.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr float presentUm = 1e-3f;       // a nanometre, as the material grid counts it
constexpr float longestMixedEdge = 1.5f; // voxels: between corners this near, trilinear phi holds nothing else

} // namespace

StackShader::StackShader(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
                         StackReading reading)
    : surface_(surface), optics_(optics), probe_(volume), reading_(reading),
      looks_(optics, reading == StackReading::points ? 0 : surface.positions.size()) {
    readVertices();
    mixed_.assign(surface_.triangles.size(), reading == StackReading::vertices);
    if (reading == StackReading::adaptive) {
        const float longest = longestMixedEdge * float(volume.scale().voxelSize);
        const auto isShort = [&](int a, int b) {
            return (surface_.positions[std::size_t(a)] - surface_.positions[std::size_t(b)]).length() <= longest;
        };
        for (std::size_t t = 0; t < mixed_.size(); ++t) {
            const V3i& corners = surface_.triangles[t];
            // Of bare metal every point is the same.
            mixed_[t] = probe_.layerCount() == 0 || (isShort(corners.x, corners.y) && isShort(corners.y, corners.z) &&
                                                     isShort(corners.z, corners.x));
        }
    }
    allMixed_ = std::find(mixed_.begin(), mixed_.end(), char(0)) == mixed_.end();
}

void StackShader::bsdfs(const HitBatch& hits, const std::vector<int>& from, std::size_t count, BsdfBatch& into) const {
    if (reading_ != StackReading::points)
        looks_.bsdfs(surface_.triangles, hits, from, count, into);
    for (std::size_t i = 0; i < count && !allMixed_; ++i) {
        const auto hit = std::size_t(from[i]);
        if (!mixes(hits.triangle[hit]))
            into.set(i, bsdf({hits.triangle[hit], hits.u[hit], hits.v[hit]}));
    }
}

void StackShader::readVertices() {
    const auto layers = std::size_t(probe_.layerCount());
    heights_.resize(surface_.positions.size());
    thicknessesUm_.resize(heights_.size() * layers);
    const bool looks = reading_ != StackReading::points;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, heights_.size(), 256), [&](const auto& range) {
        std::array<double, StackOptics::maxLayers> thickness;
        Appearance look;
        for (std::size_t v = range.begin(); v != range.end(); ++v) {
            const auto reading = probe_.read(V3d(surface_.positions[v]), V3d(surface_.normals[v]), thickness.data());
            heights_[v] = static_cast<float>(reading.height);
            float* um = thicknessesUm_.data() + v * layers;
            std::copy_n(thickness.data(), layers, um);
            if (looks) {
                optics_.evaluate(um, look);
                looks_.set(v, look);
            }
        }
    });
    if (looks)
        looks_.pack();
}

void StackShader::thicknessAt(const SurfacePoint& point, float* thicknessUm) const {
    const auto layers = std::size_t(probe_.layerCount());
    if (!mixes(point.triangle)) {
        std::array<double, StackOptics::maxLayers> thickness;
        probe_.read(positionAt(surface_, point), normalAt(surface_, point), thickness.data());
        std::copy_n(thickness.data(), layers, thicknessUm);
        return;
    }
    const V3i& corners = surface_.triangles[std::size_t(point.triangle)];
    const float weights[3] = {1.f - point.u - point.v, point.u, point.v};
    std::fill_n(thicknessUm, layers, 0.f);
    for (int i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < layers; ++k)
            thicknessUm[k] += weights[i] * thicknessesUm_[std::size_t(corners[i]) * layers + k];
}

PatinaBsdf StackShader::bsdf(const SurfacePoint& point) const {
    if (mixes(point.triangle))
        return looks_.bsdf(surface_.triangles[std::size_t(point.triangle)], point.u, point.v);
    std::array<float, StackOptics::maxLayers> thicknessUm;
    thicknessAt(point, thicknessUm.data());
    static thread_local Appearance look; // called for every path: the lobes' storage is kept
    optics_.evaluate(thicknessUm.data(), look);
    return PatinaBsdf(look);
}

PointFeatures StackShader::features(const SurfacePoint& point) const {
    std::array<float, StackOptics::maxLayers> thicknessUm;
    thicknessAt(point, thicknessUm.data());
    static thread_local Appearance look;
    optics_.evaluate(thicknessUm.data(), look);
    PointFeatures features;
    features.albedo = look.baseColour;
    for (int k = 0; k < probe_.layerCount(); ++k) {
        features.thicknessUm += thicknessUm[k];
        if (thicknessUm[k] > presentUm)
            features.material = k + 1;
    }
    return features;
}

} // namespace patina
