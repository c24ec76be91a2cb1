#include "render/stack_shader.h"

#include <tbb/parallel_for.h>

#include <array>

namespace patina {

StackShader::StackShader(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics)
    : surface_(surface), optics_(optics), probe_(volume) {}

PatinaBsdf StackShader::bsdf(const SurfacePoint& point) const {
    std::array<double, StackOptics::maxLayers> thickness;
    std::array<float, StackOptics::maxLayers> thicknessUm;
    probe_.read(positionAt(surface_, point), normalAt(surface_, point), thickness.data());
    for (int k = 0; k < probe_.layerCount(); ++k)
        thicknessUm[k] = static_cast<float>(thickness[k]);
    // Called for every path: the lobes' storage is kept from one call to the next.
    static thread_local Appearance look;
    optics_.evaluate(thicknessUm.data(), look);
    return PatinaBsdf(look);
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
