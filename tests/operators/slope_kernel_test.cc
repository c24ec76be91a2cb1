#include "operators/slope_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace patina {
namespace {

// A leaf at (-8, 0, 16) amid 26 others, of which one is missing, in a field of which the gradient is known: triangles
// all round it and a point on one of them for each active voxel.
struct Scene {
    std::vector<float> values = std::vector<float>(27 * 512);
    std::vector<float> missing = std::vector<float>(512, std::numeric_limits<float>::quiet_NaN());
    std::vector<Imath::V3f> positions;
    std::vector<Imath::V3i> triangles;
    std::vector<SurfacePoint> points;
    std::uint64_t active[8], wanted[8];
    SlopeInput slopes{};
    static constexpr float voxelSize = 0.25f;

    static float field(float x, float y, float z) { return 0.6f * x - 0.3f * y + 0.2f * z + 0.01f * x * y * z; }

    Scene() {
        std::mt19937 random(5);
        std::uniform_real_distribution<float> unit(0.f, 1.f);
        slopes.origin[0] = -8, slopes.origin[1] = 0, slopes.origin[2] = 16;
        slopes.inverseVoxelSize = 1.f / voxelSize;
        for (int leaf = 0; leaf < 27; ++leaf) {
            for (int pos = 0; pos < 512; ++pos)
                values[std::size_t(leaf * 512 + pos)] =
                    field(float(-16 + leaf / 9 * 8 + (pos >> 6)), float(-8 + leaf / 3 % 3 * 8 + (pos >> 3 & 7)),
                          float(8 + leaf % 3 * 8 + (pos & 7)));
            slopes.around[leaf] = leaf == 26 ? missing.data() : &values[std::size_t(leaf * 512)];
        }
        // From two voxels beyond the 24³ on, so that some feet lie outside.
        for (int t = 0; t < 400; ++t) {
            triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
            const Imath::V3f around(-18.f + 28.f * unit(random), -10.f + 28.f * unit(random),
                                    6.f + 28.f * unit(random));
            for (int corner = 0; corner < 3; ++corner)
                positions.push_back((around + Imath::V3f(unit(random), unit(random), unit(random))) * voxelSize);
        }
        for (int w = 0; w < 8; ++w) {
            active[w] = (std::uint64_t(random()) << 32 | random()) | 1;
            wanted[w] = active[w] & (std::uint64_t(random()) << 32 | random());
            for (std::uint64_t word = active[w]; word; word &= word - 1) {
                const float u = unit(random);
                const int triangle = points.size() % 17 == 3 ? -1 : int(random() % 400);
                points.push_back({triangle, u, (1.f - u) * unit(random)});
            }
        }
    }
    LeafFeet read(const SlopeKernel& kernel) const {
        LeafFeet feet;
        kernel.findFeet({active, wanted, points.data(), triangles.data(), positions.data(), 1.f / voxelSize}, feet);
        kernel.readSlopes(slopes, feet);
        return feet;
    }
};

TEST(SlopeKernel, ReadsTheTrilinearSlopeAtEveryFootAndSaysWhereItCannot) {
    const Scene scene;
    const LeafFeet feet = scene.read(slopeKernel(false));
    unsigned next = 0, there = 0, notThere = 0;
    int point = 0;
    for (unsigned voxel = 0; voxel < 512; ++voxel) {
        const std::uint64_t bit = std::uint64_t(1) << (voxel & 63);
        if (!(scene.active[voxel >> 6] & bit))
            continue;
        const SurfacePoint& under = scene.points[std::size_t(point++)];
        if (!(scene.wanted[voxel >> 6] & bit) || under.triangle < 0)
            continue;
        ASSERT_LT(next, feet.count);
        ASSERT_EQ(feet.voxel[next], voxel);
        const Imath::V3f* corners = &scene.positions[std::size_t(3 * under.triangle)];
        const Imath::V3f foot =
            (corners[0] + (corners[1] - corners[0]) * under.u + (corners[2] - corners[0]) * under.v) / scene.voxelSize;
        EXPECT_NEAR(feet.x[next], foot.x, 1e-5f);
        EXPECT_NEAR(feet.y[next], foot.y, 1e-5f);
        EXPECT_NEAR(feet.z[next], foot.z, 1e-5f);
        // x y z is trilinear, so the slope is the field's own.
        const Imath::V3f gradient(0.6f + 0.01f * foot.y * foot.z, -0.3f + 0.01f * foot.x * foot.z,
                                  0.2f + 0.01f * foot.x * foot.y);
        const bool among = foot.x >= -16 && foot.x < 7 && foot.y >= -8 && foot.y < 15 && foot.z >= 8 && foot.z < 31;
        const bool beside = foot.x >= -1 && foot.y >= 7 && foot.z >= 23; // a corner in the missing leaf
        if (among && !beside) {
            EXPECT_NEAR(feet.slope[next], gradient.length() / scene.voxelSize, 2e-4f) << foot;
            ++there;
        } else {
            EXPECT_EQ(feet.slope[next], -1.f) << foot;
            ++notThere;
        }
        ++next;
    }
    EXPECT_EQ(next, feet.count);
    EXPECT_GT(there, 60u);
    EXPECT_GT(notThere, 20u);
}

TEST(SlopeKernel, GivesTheSameBitsWithAndWithoutWideInstructions) {
    const Scene scene;
    const LeafFeet wide = scene.read(slopeKernel(true)), plain = scene.read(slopeKernel(false));
    ASSERT_EQ(wide.count, plain.count);
    ASSERT_GT(wide.count, 100u);
    for (unsigned i = 0; i < wide.count; ++i) {
        EXPECT_EQ(wide.voxel[i], plain.voxel[i]);
        EXPECT_EQ(std::memcmp(&wide.x[i], &plain.x[i], sizeof(float)), 0);
        EXPECT_EQ(std::memcmp(&wide.y[i], &plain.y[i], sizeof(float)), 0);
        EXPECT_EQ(std::memcmp(&wide.z[i], &plain.z[i], sizeof(float)), 0);
        EXPECT_EQ(std::memcmp(&wide.slope[i], &plain.slope[i], sizeof(float)), 0);
    }
}

} // namespace
} // namespace patina
