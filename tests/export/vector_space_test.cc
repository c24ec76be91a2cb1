// Vector displacement relative to the surface.

#include "export/vector_space.h"

#include "base/errors.h"
#include "displaced_model.h"
#include "support/test_surfaces.h"
#include "surface/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3d;

constexpr VectorSpace spaces[] = {VectorSpace::object, VectorSpace::blender, VectorSpace::materialx};

TangentFrames::Frame frameAt(const SurfaceMesh& surface, const SurfacePoint& point) {
    return TangentFrames(surface).interpolatedAt(point, normalAt(surface, point));
}

TEST(VectorSpace, namesAreReadBack) {
    for (const VectorSpace space : spaces)
        EXPECT_EQ(vectorSpaceNamed(nameOf(space)), space);
    EXPECT_THROW(vectorSpaceNamed("tangent"), RunError);
}

// On a sheet in z = 0 whose u runs along x and v along y: tangent x, bitangent y, normal z.
TEST(VectorSpace, channelsAreInTheOrderOfEachProgram) {
    const SurfaceMesh sheet = test::sheet(1.f, 2);
    const TangentFrames::Frame frame = frameAt(sheet, {3, 0.2f, 0.3f});
    const V3d vector(1, 2, 3);
    EXPECT_LT((toSpace(VectorSpace::object, frame, vector) - V3d(1, 2, 3)).length(), 1e-6);
    EXPECT_LT((toSpace(VectorSpace::blender, frame, vector) - V3d(1, 3, 2)).length(), 1e-6);
    EXPECT_LT((toSpace(VectorSpace::materialx, frame, vector) - V3d(1, 2, 3)).length(), 1e-6);
}

TEST(VectorSpace, tangentsFollowTurnedAndMirroredCharts) {
    SurfaceMesh turned = test::sheet(1.f, 2);
    for (auto& uv : turned.uvs)
        uv = {uv.y, 1.f - uv.x}; // u runs along y, v against x
    const TangentFrames::Frame frame = frameAt(turned, {0, 0.3f, 0.3f});
    EXPECT_LT((frame.tangent - V3d(0, 1, 0)).length(), 1e-6);
    EXPECT_LT((frame.bitangent - V3d(-1, 0, 0)).length(), 1e-6);
    SurfaceMesh mirrored = test::sheet(1.f, 2);
    for (auto& uv : mirrored.uvs)
        uv.x = 1.f - uv.x;
    const TangentFrames::Frame other = frameAt(mirrored, {0, 0.3f, 0.3f});
    EXPECT_LT((other.tangent - V3d(-1, 0, 0)).length(), 1e-6);
    EXPECT_LT((other.bitangent - V3d(0, 1, 0)).length(), 1e-6);
}

// Also where UVs have no area, and where they are missing their sense.
TEST(VectorSpace, everyVectorComesBack) {
    SurfaceMesh ball = test::sphere(1.f, 3);
    for (const auto& p : ball.positions)
        ball.uvs.emplace_back(0.5f + 0.15f * p.x + 0.1f * p.y * p.y, p.z > 0.9f ? 0.95f : 0.5f + 0.4f * p.z);
    ball.triangleUvs = ball.triangles;
    const TangentFrames frames(ball);
    double worst = 0.0;
    for (int t = 0; t < static_cast<int>(ball.triangles.size()); ++t) {
        const SurfacePoint point{t, 0.25f, 0.4f};
        const TangentFrames::Frame frame = frames.interpolatedAt(point, normalAt(ball, point));
        EXPECT_NEAR(frame.tangent.length(), 1.0, 1e-9);
        EXPECT_NEAR(frame.bitangent.dot(frame.normal), 0.0, 1e-9);
        EXPECT_LT(std::abs(frame.tangent.dot(frame.normal)), 0.3);
        const V3d vector(std::sin(t), std::cos(2.0 * t), 0.5);
        for (const VectorSpace space : spaces)
            worst = std::max(worst, (fromSpace(space, frame, toSpace(space, frame, vector)) - vector).length());
    }
    EXPECT_LT(worst, 1e-9);
}

// A sphere displaced by vectors of any frame is the voxels' surface; and not if the channels are taken for another's.
TEST(VectorSpace, VectorsInAnySpaceDisplaceOntoTheVoxelSurface) {
    const Mesh ball = makeShape("sphere");
    for (const VectorSpace space : spaces) {
        const test::Measured measured = test::measure(ball, 48, 256, 2, false, true, space);
        test::expectControl(measured);
        test::expectTheVoxelSurface(measured, 5000);
        if (space != VectorSpace::object) {
            EXPECT_GT(measured.otherSpace.meshToVolume.rms, measured.displaced.meshToVolume.rms + 1.0);
        }
    }
}

} // namespace
} // namespace patina
