#include "volume/voxelize.h"

#include "base/errors.h"
#include "support/on_threads.h"
#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(Voxelize, ASphereIsItsDistance) {
    const auto piece = test::makePiece(test::sphere(30.f, 5), test::voxelScale());
    double worst = 0.0;
    for (const FloatLeaf* leaf : leavesOf(std::as_const(piece->volume->grids().base->tree())))
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) {
            const double truth = piece->volume->grids().space.position(voxel.getCoord()).length() - 30.0;
            worst = std::max(worst, std::abs(*voxel - truth));
        }
    // Edges of the geodesic sphere are 1.2 voxels long; its faces lie up to e²/(6R) = 0.008 below the sphere.
    EXPECT_LT(worst, 0.02);
}

TEST(Voxelize, TheLatticeIsAnchoredAtTheOrigin) {
    VolumeScale scale;
    scale.voxelSize = 0.01;
    SurfaceMesh surface = test::sphere(0.1f, 3);
    for (auto& p : surface.positions)
        p += Imath::V3f(5.f, 0.f, 0.f);
    const auto piece = test::makePiece(std::move(surface), scale);
    const auto& grid = *piece->volume->grids().base;
    const openvdb::Coord middle = piece->volume->grids().space.index(500, 0, 0);
    EXPECT_LT(grid.tree().getValue(middle), 0.f);
    EXPECT_NEAR(grid.transform().indexToWorld(middle).x(), 5.0, 1e-9);
}

TEST(Voxelize, AModelAroundTheOriginLiesUnderOneUpperNode) {
    for (const Imath::V3f& middle : {Imath::V3f(0.f), Imath::V3f(4096.f, -8192.f, 50000.f), Imath::V3f(-700.f)}) {
        SurfaceMesh surface = test::sphere(70.f, 4);
        for (auto& p : surface.positions)
            p += middle;
        const auto piece = test::makePiece(std::move(surface), test::voxelScale());
        const NestGrids& grids = piece->volume->grids();
        const auto nodes = grids.base->tree().nodeCount(); // leaves, lower, upper, root
        EXPECT_EQ(nodes[2], 1u) << middle;
        EXPECT_EQ(nodes[1], 8u) << middle; // 148 voxels across take two of 128 along each axis
        EXPECT_EQ(IndexSpace(grids.base->transform()), grids.space);
        EXPECT_EQ(grids.material->transform(), grids.base->transform());
        EXPECT_LT(grids.base->tree().getValue(grids.space.index(Imath::V3i(middle))), 0.f);
    }
}

TEST(Voxelize, AnOpenSheetGetsABack) {
    const auto piece = test::makePiece(test::sheet(20.f, 10), test::voxelScale());
    const auto& tree = piece->volume->grids().base->tree();
    const IndexSpace& space = piece->volume->grids().space;
    EXPECT_LT(tree.getValue(space.index(10, 10, -2)), 0.f);
    EXPECT_GT(tree.getValue(space.index(10, 10, 2)), 0.f);
    EXPECT_GT(tree.getValue(space.index(10, 10, -10)), 0.f);
    EXPECT_NEAR(tree.getValue(space.index(10, 10, 2)), 2.0, 1e-5);
}

TEST(Voxelize, AModelThatNoVoxelSeesIsAnErrorOfTheModel) {
    SurfaceMesh grain = test::sphere(0.01f, 2);
    for (auto& p : grain.positions)
        p += Imath::V3f(0.5f);
    EXPECT_THROW(test::makePiece(std::move(grain), test::voxelScale()), ModelError);
}

TEST(Voxelize, GivesTheSameBitsOnAnyNumberOfThreads) {
    std::string first;
    for (const std::size_t threads : {1, 2, 4})
        test::onThreads(threads, [&] {
            const auto piece = test::makePiece(test::sphere(25.f, 4), test::voxelScale());
            const std::string hash = contentHash(*piece->volume);
            if (first.empty())
                first = hash;
            EXPECT_EQ(hash, first) << threads;
        });
}

} // namespace
} // namespace patina
