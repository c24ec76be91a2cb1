#include "volume/surface_contacts.h"

#include <tbb/parallel_for.h>

namespace patina {

namespace {

constexpr int padLow = 2, padHigh = 3, padded = 8 + padLow + padHigh; // a seed on an edge may have left its block

// The trilinear interpolant of a padded block at a point in voxels from the block's origin.
float valueAt(const float* values, const Imath::V3f& p) {
    int cell[3];
    float f[3];
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = std::clamp(int(std::floor(p[axis])), -padLow, 8 + padHigh - 2);
        f[axis] = p[axis] - float(cell[axis]);
    }
    const float* v = values + ((cell[0] + padLow) * padded + cell[1] + padLow) * padded + cell[2] + padLow;
    const auto mixed = [](float a, float b, float share) { return a + share * (b - a); };
    const auto face = [&](const float* w) {
        return mixed(mixed(w[0], w[1], f[2]), mixed(w[padded], w[padded + 1], f[2]), f[1]);
    };
    return mixed(face(v), face(v + padded * padded), f[0]);
}

} // namespace

SurfaceContacts::SurfaceContacts(const LevelSetBlocks& levelSet, const SurfaceSeeds& seeds, double voxelSize)
    : seeds_(seeds), heights_(seeds.patches.size()) {
    // Further out than this a point is not of this surface.
    constexpr float farOut = 0.05f;
    const auto voxelsPerUnit = static_cast<float>(1.0 / voxelSize);
    const PointBlocks& points = seeds.points;
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t b) {
        const PointBlocks::Block& block = points.blocks[b];
        float values[padded * padded * padded];
        levelSet.padded(block.block, padLow, padHigh, values);
        for (std::uint32_t s = block.begin; s < block.end; ++s) {
            const SurfacePatch& patch = seeds.patches[s];
            if (patch.crease)
                continue;
            const Imath::V3f point(points.x[s], points.y[s], points.z[s]);
            const contacts::Across across(patch.normal);
            const float far = reachOf(s);
            for (int i = 0; i < 8; ++i) {
                const Imath::V3f u = across.onCircle(i) * far;
                float height = -0.5f * u.dot(patch.bend(u)), out = 0.f;
                for (int step = 0; step < 2; ++step) {
                    out = valueAt(values, point + u + patch.normal * height) * voxelsPerUnit;
                    height -= std::max(out, 0.f);
                }
                out = valueAt(values, point + u + patch.normal * height) * voxelsPerUnit;
                heights_[s][i] = out > farOut ? contacts::none : height;
            }
        }
    });
}

float SurfaceContacts::heightOf(std::size_t seed) const {
    float most = 0.f;
    if (!seeds_.patches[seed].crease)
        for (const float height : heights_[seed])
            if (height != contacts::none)
                most = std::max(most, std::abs(height));
    return most;
}

} // namespace patina
