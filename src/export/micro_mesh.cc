#include "export/micro_mesh.h"

#include "optics/colour.h"
#include "surface/vertex_normals.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {

namespace {

float encodedSrgb(double linear) {
    const double value = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055);
}

} // namespace

SurfaceMesh makeMicroMesh(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
                          bool keepExaggeration, Progress& progress) {
    SurfaceMesh mesh = surface;
    mesh.vertexAttributes.clear();
    const std::size_t count = surface.positions.size();
    const int layers = volume.layerCount();
    std::vector<std::vector<float>*> thicknesses;
    for (int k = 1; k <= layers; ++k) {
        auto& values = mesh.vertexAttributes[fmt::format("thickness_{:02d}_{}", k, volume.layers()[k - 1])];
        values.resize(count);
        thicknesses.push_back(&values);
    }
    std::vector<float>& ids = mesh.vertexAttributes["material_id"];
    std::vector<float>* colours[3] = {&mesh.vertexAttributes["red"], &mesh.vertexAttributes["green"],
                                      &mesh.vertexAttributes["blue"]};
    ids.resize(count);
    for (auto* channel : colours)
        channel->resize(count);
    std::vector<float> idOf{1.f};
    for (const std::string& layer : volume.layers())
        idOf.push_back(static_cast<float>(volume.findMaterialId(layer)));

    const StackProbe probe(volume);
    const StackOptics rec709 = optics.in(ColourSpace::rec709);
    const double scale = keepExaggeration ? 1.0 : 1.0 / volume.scale().exaggeration;
    constexpr std::size_t chunk = 1024;
    tbb::parallel_for(std::size_t(0), (count + chunk - 1) / chunk, [&](std::size_t c) {
        if (progress.cancelled())
            return;
        std::vector<double> thickness(std::max(layers, 1));
        std::vector<float> thicknessUm(std::max(layers, 1));
        Appearance look;
        for (std::size_t i = c * chunk; i < std::min(count, (c + 1) * chunk); ++i) {
            const Imath::V3d position(surface.positions[i]), normal(surface.normals[i]);
            const auto reading = probe.read(position, normal, thickness.data());
            mesh.positions[i] = Imath::V3f(position + normal * (reading.height * scale));
            int visible = 0;
            for (int k = 0; k < layers; ++k) {
                thicknessUm[k] = static_cast<float>(thickness[k]);
                (*thicknesses[k])[i] = thicknessUm[k];
                if (thickness[k] > 1e-3) // a nanometre, as in the maps
                    visible = k + 1;
            }
            ids[i] = idOf[visible];
            rec709.evaluate(thicknessUm.data(), look);
            for (int channel = 0; channel < 3; ++channel)
                (*colours[channel])[i] = encodedSrgb(look.baseColour[channel]);
        }
    });
    progress.checkpoint();
    mesh.normals = angleWeightedNormals(mesh.positions, mesh.triangles);
    return mesh;
}

} // namespace patina
