#include "render/stack_shader.h"

#include <tbb/parallel_for.h>

#include <array>

namespace patina {

StackShader::StackShader(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics)
    : surface_(surface), optics_(optics), probe_(volume) {}

namespace {

constexpr float presentUm = 1e-3f; // a nanometre, as the material grid counts it

} // namespace

const Appearance& StackShader::look(const SurfacePoint& point, float* thicknessUm) const {
    std::array<double, StackOptics::maxLayers> thickness;
    probe_.read(positionAt(surface_, point), normalAt(surface_, point), thickness.data());
    for (int k = 0; k < probe_.layerCount(); ++k)
        thicknessUm[k] = static_cast<float>(thickness[k]);
    // Called for every path: the lobes' storage is kept from one call to the next.
    static thread_local Appearance look;
    optics_.evaluate(thicknessUm, look);
    return look;
}

PatinaBsdf StackShader::bsdf(const SurfacePoint& point) const {
    std::array<float, StackOptics::maxLayers> thicknessUm;
    return PatinaBsdf(look(point, thicknessUm.data()));
}

PointFeatures StackShader::features(const SurfacePoint& point) const {
    std::array<float, StackOptics::maxLayers> thicknessUm;
    PointFeatures features;
    features.albedo = look(point, thicknessUm.data()).baseColour;
    for (int k = 0; k < probe_.layerCount(); ++k) {
        features.thicknessUm += thicknessUm[k];
        if (thicknessUm[k] > presentUm)
            features.material = k + 1;
    }
    return features;
}

std::vector<float> StackShader::vertexHeights() const {
    std::vector<float> heights(surface_.positions.size());
    tbb::parallel_for(std::size_t(0), heights.size(), [&](std::size_t v) {
        std::array<double, StackOptics::maxLayers> thickness;
        heights[v] = static_cast<float>(
            probe_.read(Imath::V3d(surface_.positions[v]), Imath::V3d(surface_.normals[v]), thickness.data()).height);
    });
    return heights;
}

} // namespace patina
