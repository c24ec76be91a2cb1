#include "operators/fields/drainage.h"

#include "operators/fields/voxel_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace patina {

using Imath::V3d;
using Imath::V3f;

namespace {

constexpr int ways = 4; // the four best neighbours take all

struct Outlets {
    std::array<std::int32_t, ways> to;
    std::array<float, ways> share; ///< sum to 1, or all 0 in a hollow
};

Outlets outletsOf(const SurfaceVoxels& surface, const VoxelTable& table, const V3f& up, std::size_t i) {
    Outlets out{{-1, -1, -1, -1}, {0.f, 0.f, 0.f, 0.f}};
    const V3f& n = surface.normals[i];
    const V3f& p = surface.feet[i];
    V3f downhill = n * n.dot(up) - up;
    const float slope = downhill.length();
    if (slope > 1e-4f)
        downhill /= slope;
    for (int c = 0; c < 27; ++c) {
        if (c == 13)
            continue;
        const int j = table.find(surface.voxels[i] + Imath::V3i(c / 9 - 1, c / 3 % 3 - 1, c % 3 - 1));
        if (j < 0)
            continue;
        const V3f d = surface.feet[j] - p;
        const float length = d.length(), drop = -d.dot(up);
        if (length < 0.05f || drop < 1e-3f * length || n.dot(surface.normals[j]) < -0.3f)
            continue;
        const float along = slope > 1e-4f ? d.dot(downhill) / length : 1.f;
        if (along < 0.2f)
            continue;
        const float weight = std::pow(along, 4.f) * (drop / length + 0.05f);
        // Kept sorted, largest first; ties keep the order of the neighbours.
        for (int k = 0; k < ways; ++k)
            if (weight > out.share[k]) {
                for (int l = ways - 1; l > k; --l) {
                    out.share[l] = out.share[l - 1];
                    out.to[l] = out.to[l - 1];
                }
                out.share[k] = weight;
                out.to[k] = j;
                break;
            }
    }
    const float sum = std::accumulate(out.share.begin(), out.share.end(), 0.f);
    if (sum > 0.f)
        for (float& share : out.share)
            share /= sum;
    return out;
}

} // namespace

Drainage drain(const SurfaceVoxels& surface, const V3d& upward, const std::vector<float>& rain) {
    const V3f up(upward);
    const VoxelTable table(surface.voxels);
    std::vector<Outlets> outlets(surface.size());
    std::vector<float> height(surface.size());
    tbb::parallel_for(std::size_t(0), surface.size(), [&](std::size_t i) {
        outlets[i] = outletsOf(surface, table, up, i);
        height[i] = surface.feet[i].dot(up);
    });
    std::vector<std::int32_t> order(surface.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return height[a] > height[b] || (height[a] == height[b] && a < b);
    });

    Drainage drainage;
    drainage.passing.assign(surface.size(), 0.f);
    drainage.retained.assign(surface.size(), 0.f);
    for (const std::int32_t i : order) {
        const float facing = surface.normals[i].dot(up);
        const float clings = std::clamp((facing + 1.f) / (1.f - 0.34f), 0.f, 1.f);
        const float on = (drainage.passing[i] + rain[i]) * clings;
        const Outlets& out = outlets[i];
        if (out.to[0] < 0) {
            drainage.retained[i] = facing > 0.f ? 1.f : 0.f;
            continue;
        }
        for (int k = 0; k < ways && out.to[k] >= 0; ++k)
            drainage.passing[out.to[k]] += on * out.share[k];
    }
    return drainage;
}

} // namespace patina
