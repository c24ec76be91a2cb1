#include "operators/fields/surface_average.h"

#include "operators/fields/voxel_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

constexpr int mostNeighbours = 26;

// Those beside a voxel, with weights whose sum is 1 and whose mean square distance is `spread`.
struct Neighbours {
    std::array<std::int32_t, mostNeighbours> to;
    std::array<float, mostNeighbours> weight;
    int count = 0;
    float spread = 0.f; ///< square voxels
};

Neighbours neighboursOf(const SurfaceVoxels& surface, const VoxelTable& table, std::size_t i) {
    Neighbours near;
    float sum = 0.f;
    for (int c = 0; c < 27; ++c) {
        const int j = table.find(surface.voxels[i] + V3i(c / 9 - 1, c / 3 % 3 - 1, c % 3 - 1));
        if (c == 13 || j < 0 || surface.normals[i].dot(surface.normals[std::size_t(j)]) <= 0.f)
            continue;
        const float squared = (surface.feet[std::size_t(j)] - surface.feet[i]).length2();
        const float weight = std::exp(-0.5f * squared);
        near.to[std::size_t(near.count)] = j;
        near.weight[std::size_t(near.count++)] = weight;
        near.spread += weight * squared;
        sum += weight;
    }
    if (sum > 0.f) {
        for (int k = 0; k < near.count; ++k)
            near.weight[std::size_t(k)] /= sum;
        near.spread /= sum;
    }
    return near;
}

} // namespace

std::vector<float> surfaceAverage(const SurfaceVoxels& surface, const std::vector<float>& values,
                                  double deviationVoxels, Progress& progress) {
    // A Gaussian has a mean square distance of sigma^2 along each of the surface's two directions. Each pass brings an
    // equal part of it, by taking over from the neighbours as much as their distances need: never more than all.
    constexpr double mostPerPass = 0.4; // square voxels; neighbours spread over 1 and more
    const double whole = 2.0 * deviationVoxels * deviationVoxels;
    const int passes = static_cast<int>(std::ceil(whole / mostPerPass));
    if (passes == 0)
        return values;
    const float part = static_cast<float>(whole / passes);
    const VoxelTable table(surface.voxels);
    std::vector<Neighbours> neighbours(surface.size());
    tbb::parallel_for(std::size_t(0), surface.size(),
                      [&](std::size_t i) { neighbours[i] = neighboursOf(surface, table, i); });
    std::vector<float> now = values, next(values.size());
    for (int pass = 0; pass < passes; ++pass) {
        tbb::parallel_for(std::size_t(0), surface.size(), [&](std::size_t i) {
            const Neighbours& near = neighbours[i];
            float mean = 0.f;
            for (int k = 0; k < near.count; ++k)
                mean += near.weight[std::size_t(k)] * now[std::size_t(near.to[std::size_t(k)])];
            const float share = near.spread > part ? part / near.spread : near.count > 0 ? 1.f : 0.f;
            next[i] = now[i] + share * (mean - now[i]);
        });
        now.swap(next);
        progress.checkpoint();
    }
    return now;
}

} // namespace patina
