#include "volume/layer_statistics.h"

#include "volume/stack_probe.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

StackStatistics measureStack(const LayerVolume& volume, const SurfaceMesh& surface, std::size_t every) {
    const StackProbe probe(volume);
    const std::size_t layers = static_cast<std::size_t>(volume.layerCount());
    const std::size_t count = surface.triangles.size();

    // Read in parallel into place, add up in order: sums must not depend on the threads.
    std::vector<double> thickness(count * layers);
    std::vector<double> area(count);
    std::vector<double> offset(count);
    std::vector<double> lossUm(count);
    std::vector<char> found(count);
    constexpr std::size_t block = 1024;
    tbb::parallel_for(std::size_t(0), (count + block - 1) / block, [&](std::size_t b) {
        std::vector<double> none(1);
        for (std::size_t t = b * block; t < std::min(count, (b + 1) * block); ++t) {
            const Imath::V3i& corners = surface.triangles[t];
            const Imath::V3d a(surface.positions[corners[0]]), p(surface.positions[corners[1]]),
                q(surface.positions[corners[2]]);
            area[t] = 0.5 * (p - a).cross(q - a).length();
            if (t % every != 0)
                continue;
            const SurfacePoint centre{static_cast<int>(t), 1.f / 3.f, 1.f / 3.f};
            const auto reading = probe.read(positionAt(surface, centre), normalAt(surface, centre),
                                            layers ? &thickness[t * layers] : none.data());
            found[t] = reading.found;
            offset[t] = reading.baseOffset;
            lossUm[t] = -reading.metalHeight / volume.scale().unitsPerUm();
        }
    });

    StackStatistics result;
    const double metres = volume.scale().metresPerUnit;
    double total = 0.0, asked = 0.0, read = 0.0, offsetSquares = 0.0;
    // The layers, their sum, and the metal that is gone.
    std::vector<double> sum(layers + 2, 0.0), squares(layers + 2, 0.0), most(layers + 2, 0.0), covered(layers + 2, 0.0);
    for (std::size_t t = 0; t < count; ++t) {
        total += area[t];
        asked += t % every == 0 ? area[t] : 0.0;
        if (!found[t])
            continue;
        read += area[t];
        offsetSquares += area[t] * offset[t] * offset[t];
        double stack = 0.0;
        const auto add = [&](std::size_t k, double um) {
            sum[k] += area[t] * um;
            squares[k] += area[t] * um * um;
            most[k] = std::max(most[k], um);
            covered[k] += um > 1e-3 ? area[t] : 0.0;
        };
        for (std::size_t k = 0; k < layers; ++k) {
            add(k, thickness[t * layers + k]);
            stack += thickness[t * layers + k];
        }
        add(layers, stack);
        add(layers + 1, lossUm[t]);
    }
    const double weight = read > 0.0 ? 1.0 / read : 0.0;
    const auto summarise = [&](std::size_t k, const std::string& name) {
        LayerStatistics s;
        s.material = name;
        s.meanUm = sum[k] * weight;
        s.maxUm = most[k];
        s.coverage = covered[k] * weight;
        s.roughnessUm = std::sqrt(std::max(0.0, squares[k] * weight - s.meanUm * s.meanUm));
        s.volumeM3 = s.meanUm * 1e-6 * total * metres * metres;
        return s;
    };
    for (std::size_t k = 0; k < layers; ++k)
        result.layers.push_back(summarise(k, volume.layers()[k]));
    result.total = summarise(layers, "stack");
    result.metalLoss = summarise(layers + 1, volume.metal());
    result.areaM2 = total * metres * metres;
    result.voxelizationErrorVoxels = std::sqrt(offsetSquares * weight) / volume.scale().voxelSize;
    result.unreadable = asked > 0.0 ? 1.0 - read / asked : 0.0;
    return result;
}

} // namespace patina
