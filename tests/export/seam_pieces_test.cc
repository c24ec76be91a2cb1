#include "export/seam_pieces.h"

#include "displaced_distance.h"
#include "seam_jumps.h"

#include <gtest/gtest.h>

#include <random>

namespace patina {
namespace {

constexpr int size = 64;

// Two triangles that meet in an edge, whose UVs lie apart, turned against each other.
SurfaceMesh cutSquare() {
    SurfaceMesh surface;
    surface.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    surface.normals.assign(4, {0, 0, 1});
    surface.triangles = {{0, 1, 2}, {0, 2, 3}};
    surface.uvs = {{0.f, 0.02f}, {0.42f, 0.1f}, {0.37f, 0.49f}, {0.55f, 0.6f}, {0.93f, 1.f}, {0.51f, 0.98f}};
    surface.triangleUvs = {{0, 1, 2}, {3, 4, 5}};
    return surface;
}

// White noise: nothing jumps more.
MapImage noise() {
    MapImage map;
    map.size = size;
    map.channels = 1;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> height(-1.f, 1.f);
    for (int i = 0; i < size * size; ++i)
        map.floats.push_back(height(random));
    return map;
}

TEST(SeamPieces, JumpsStayWithinFiveQuartersOfTheirThreePoints) {
    const SurfaceMesh surface = cutSquare();
    const SurfaceWalk walk(surface);
    const auto pieces = seamPieces(walk, {{0, 0}}, size, 1.0);
    // A side of about 38 texels crosses 27 to 38 lines of both directions.
    ASSERT_GT(pieces.size(), 80u);
    const MapImage map = noise();
    MapImage folds = map;
    std::fill(folds.floats.begin(), folds.floats.end(), 0.f);
    float most = 0.f;
    for (const SeamPiece& piece : pieces) {
        most = std::max(most, piece.largestJump(map.floats)); // of one tile: keys are places in the map
        for (int half = 0; half < 3; ++half) {
            float here = 0.f, there = 0.f;
            for (int i = 0; i < 8; ++i)
                (i < 4 ? here : there) += piece.weights(half)[i];
            EXPECT_NEAR(here, 1.f, 1e-5f);
            EXPECT_NEAR(there, -1.f, 1e-5f);
        }
    }
    const auto jumps = test::seamJumps(surface, map, folds, 20001);
    EXPECT_GT(most, 0.5f);
    EXPECT_LE(jumps.open.back(), 1.25 * most + 1e-4);
    EXPECT_GE(jumps.open.back(), most - 1e-2); // the same seam was read
}

TEST(SeamPieces, NoiseCrossesWallsAndASlopeDoesNot) {
    const SurfaceMesh surface = cutSquare();
    const SurfaceWalk walk(surface);
    const MapImage map = noise();
    std::vector<float> slope(size * size);
    for (int i = 0; i < size * size; ++i)
        slope[i] = 0.01f * float(i % size);
    int walls = 0;
    const auto pieces = seamPieces(walk, {{0, 0}}, size, 0.02);
    for (const SeamPiece& piece : pieces) {
        walls += piece.crossesWall(map.floats);
        EXPECT_FALSE(piece.crossesWall(slope));
    }
    EXPECT_GT(walls, static_cast<int>(pieces.size()) * 9 / 10);
}

} // namespace
} // namespace patina
