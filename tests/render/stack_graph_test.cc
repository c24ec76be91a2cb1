#include "render/stack_graph.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "operators/erode.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

const std::vector<SectionMaterial> materials = {
    {"copper", {0.9f, 0.5f, 0.3f}}, {"cuprite_2", {0.4f, 0.1f, 0.1f}}, {"brochantite", {0.3f, 0.7f, 0.5f}}};

StackGraphOptions atPole() {
    StackGraphOptions options;
    options.at = Imath::V3d(30.0, 0.0, 0.0);
    return options;
}

TEST(StackGraph, SpansAreTheLayers) {
    auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    Workpiece work = piece->work();
    coat(work, "cuprite_2", 0.02, nullptr, piece->progress); // far thinner than a voxel
    coat(work, "brochantite", 1.0, nullptr, piece->progress);
    const StackGraph graph = drawStackGraph(*piece->volume, materials, atPole());
    ASSERT_EQ(graph.spans.size(), 4u);
    const int regions[] = {0, 1, 2, -1};
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(graph.spans[std::size_t(i)].region, regions[i]);
    EXPECT_NEAR(graph.spans[1].toUm - graph.spans[1].fromUm, 0.02, 0.001);
    EXPECT_NEAR(graph.spans[1].fromUm, 0.0, 0.02) << "heights are above the metal";
    EXPECT_NEAR(graph.spans[2].toUm - graph.spans[2].fromUm, 1.0, 0.01);
    for (std::size_t i = 1; i < 4; ++i)
        EXPECT_DOUBLE_EQ(graph.spans[i].fromUm, graph.spans[i - 1].toUm);
    // As high in the picture as they are thick: brochantite takes 1 of the 1.02 · 1.4 that are drawn.
    int rows = 0;
    for (int y = 0; y < graph.image.height; ++y)
        rows += (graph.image.rgb(120, y) - materials[2].colour).length() < 1e-3f;
    const int plot = graph.image.height - 4 * 14; // head and foot take four letters of 640 / 44 pixels
    EXPECT_NEAR(rows / double(plot), 1.0 / (1.02 * 1.4), 0.02);
}

TEST(StackGraph, ErodedMetalEndsBelowZero) {
    auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    Workpiece work = piece->work();
    erode(work, 2.0, nullptr, {}, piece->progress, 1.0);
    const StackGraph graph = drawStackGraph(*piece->volume, materials, atPole());
    ASSERT_EQ(graph.spans.size(), 2u);
    EXPECT_NEAR(graph.spans[0].toUm, -2.0, 0.05);
    EXPECT_LT(graph.spans[0].fromUm, -2.0);
}

TEST(StackGraph, BareMetalIsAGraphTooAndNoMetalIsAnError) {
    auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    const StackGraph graph = drawStackGraph(*piece->volume, materials, atPole());
    ASSERT_EQ(graph.spans.size(), 2u);
    EXPECT_NEAR(graph.spans[0].toUm, 0.0, 0.02);
    StackGraphOptions options;
    options.at = Imath::V3d(90.0, 0.0, 0.0);
    EXPECT_THROW(drawStackGraph(*piece->volume, materials, options), RunError);
}

} // namespace
} // namespace patina
