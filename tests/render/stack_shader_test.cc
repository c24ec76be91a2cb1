// The stack read at vertices against the stack read at every point.

#include "render/stack_shader.h"

#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"
#include "volume/interface_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3f;

const V3f up(0, 0, 1), aside(0.6f, 0.f, 0.8f);

const MaterialLibrary& materials() {
    static const MaterialLibrary library = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    return library;
}

StackOptics optics() {
    return StackOptics({&materials().at("copper"), &materials().at("cuprite_2"), &materials().at("brochantite")});
}

// A sphere of 20 voxels under two layers, the outer one in spots a few voxels wide.
class ShadedSphere : public testing::Test {
  protected:
    ShadedSphere() : piece(test::makePiece(test::sphere(20.f, 5), test::voxelScale(), 6.0)) {
        auto work = piece->work();
        coat(work, "cuprite_2", 0.4, nullptr, piece->progress);
        const test::FunctionMap spots([](const MapPoint& at) {
            return 0.5 + 0.5 * std::sin(at.position.x) * std::sin(at.position.y) * std::sin(at.position.z);
        });
        coat(work, "brochantite", 2.0, &spots, piece->progress);
    }

    std::unique_ptr<test::Piece> piece;
    StackOptics looks = optics();
};

TEST_F(ShadedSphere, VerticesTellWhatPointsDo) {
    const SurfaceMesh& surface = piece->surface;
    const StackShader mixed(*piece->volume, surface, looks, StackReading::vertices);
    const StackShader exact(*piece->volume, surface, looks, StackReading::points);
    EXPECT_EQ(mixed.vertexHeights(), exact.vertexHeights());
    double sum = 0.0, difference = 0.0, features = 0.0;
    const int triangles = int(surface.triangles.size());
    for (int t = 0; t < triangles; t += 7) {
        const SurfacePoint point{t, 0.3f, 0.45f};
        const V3f a = mixed.bsdf(point).evaluate(up, aside), b = exact.bsdf(point).evaluate(up, aside);
        sum += double(b.y);
        difference += double(a.y - b.y);
        features += double(mixed.features(point).thicknessUm - exact.features(point).thicknessUm);
    }
    EXPECT_GT(sum, 0.0);
    EXPECT_NEAR(difference / sum, 0.0, 0.005); // what pictures may differ by on average
    EXPECT_NEAR(features / triangles, 0.0, 0.01);
}

TEST_F(ShadedSphere, LargeTrianglesAreReadAtThePoint) {
    SurfaceMesh coarse = piece->surface; // two of its triangles made of far corners
    coarse.triangles = {piece->surface.triangles[0], {0, int(coarse.positions.size()) / 2, 7}};
    const StackShader adaptive(*piece->volume, coarse, looks);
    const StackShader exact(*piece->volume, coarse, looks, StackReading::points);
    const SurfacePoint point{1, 0.01f, 0.01f};
    EXPECT_EQ(adaptive.bsdf(point).evaluate(up, aside), exact.bsdf(point).evaluate(up, aside));
    EXPECT_EQ(adaptive.features(point).thicknessUm, exact.features(point).thicknessUm);
}

TEST_F(ShadedSphere, TheBasesSlopesAreTheSpheresNormalsUnderAnyCoat) {
    const SurfaceMesh air = interfaceMesh(*piece->volume, 2);
    const std::vector<V3f> under = baseSlopes(*piece->volume, air.positions);
    for (std::size_t v = 0; v < under.size(); ++v)
        ASSERT_NEAR((under[v] - air.positions[v].normalized()).length(), 0.f, 0.1f);
    EXPECT_EQ(baseSlopes(*piece->volume, {V3f(500.f, 0.f, 0.f)})[0], V3f(0.f));
    for (const float way : {-1.f, 0.f, 1.f})
        EXPECT_NEAR(baseDistances(*piece->volume, {V3f(20.f + way, 0.f, 0.f)})[0], way, 0.05f);
    EXPECT_TRUE(isInsideVolume(*piece->volume, V3f(0.f)));
    EXPECT_TRUE(isInsideVolume(*piece->volume, V3f(20.3f, 0.f, 0.f)));
    EXPECT_FALSE(isInsideVolume(*piece->volume, V3f(23.5f, 0.f, 0.f)));
}

// A mix of looks is the mix of their reflections where the lobes' widths are the materials'.
TEST(LookTable, MixesInProportion) {
    const StackOptics looks = optics();
    LookTable table(looks, 3);
    Appearance look[3];
    const float thick[3][2] = {{0.f, 0.f}, {1.f, 0.f}, {0.5f, 4.f}};
    for (int v = 0; v < 3; ++v) {
        looks.evaluate(thick[v], look[v]);
        table.set(std::size_t(v), look[v]);
    }
    table.pack();
    const Imath::V3i corners(0, 1, 2);
    const float at[3][2] = {{0.f, 0.f}, {1.f, 0.f}, {0.f, 1.f}};
    for (int v = 0; v < 3; ++v) {
        const V3f own = PatinaBsdf(look[v]).evaluate(up, aside);
        EXPECT_NEAR((table.bsdf(corners, at[v][0], at[v][1]).evaluate(up, aside) - own).length(), 0.f, 1e-5f);
    }
    const V3f middle = table.bsdf(corners, 0.25f, 0.5f).evaluate(up, aside);
    V3f mean(0.f);
    for (int v = 0; v < 3; ++v)
        mean += PatinaBsdf(look[v]).evaluate(up, aside) * (v == 2 ? 0.5f : 0.25f);
    // Not exactly: what passes the air is a product.
    EXPECT_NEAR(middle.y / mean.y, 1.f, 0.02f);
}

} // namespace
} // namespace patina
