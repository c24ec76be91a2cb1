#include "volume/open_air.h"

#include "support/hollow_ball.h"
#include "support/on_threads.h"
#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

#include <chrono>

namespace patina {
namespace {

std::unique_ptr<test::Piece> hollowBall(float hollow, double channel = 0.0) {
    return test::hollowBall(30.f, hollow, channel);
}

TEST(OpenAir, ABallHasNoClosedAir) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    const OpenAir air(*piece->volume);
    EXPECT_FALSE(air.anyClosed());
    EXPECT_EQ(air.sealed(0), OpenAir::Mask{});
}

TEST(OpenAir, AHollowIsClosedAndSoIsItsWall) {
    for (const float hollow : {3.f, 16.f}) { // all in the band, and with a middle that is not
        const auto piece = hollowBall(hollow);
        const auto& tree = piece->volume->grids().base->tree();
        ASSERT_GT(tree.getValue(piece->volume->grids().space.index(0, 0, 0)), 0.f);
        const OpenAir air(*piece->volume);
        ASSERT_TRUE(air.anyClosed());
        EXPECT_EQ(air.closedPores(), 1u);
        const auto leaves = leavesOf(std::as_const(tree));
        for (std::size_t n = 0; n < leaves.size(); ++n)
            for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel) {
                const Imath::V3d c = piece->volume->grids().space.position(voxel.getCoord());
                const double r = c.length();
                EXPECT_EQ(air.isSealed(n, voxel.pos()), r < 0.5 * (30 + hollow)) << c;
            }
    }
}

TEST(OpenAir, AChannelOpensTheHollow) {
    const auto piece = hollowBall(23.f, 2.0);
    EXPECT_TRUE(OpenAir(*hollowBall(23.f)->volume).anyClosed());
    EXPECT_FALSE(OpenAir(*piece->volume).anyClosed());
}

TEST(OpenAir, ExclusionZeroesWhatAirDoesNotReach) {
    const auto piece = hollowBall(3.f);
    std::vector<float> thickness(piece->volume->activeVoxels(), 1.f);
    const OpenAir air(*piece->volume);
    const std::size_t excluded = excludeClosedAir(*piece->volume, air, thickness);
    EXPECT_GT(excluded, 113u); // the hollow alone has 4/3 pi 27 voxels
    EXPECT_EQ(static_cast<std::size_t>(std::count(thickness.begin(), thickness.end(), 0.f)), excluded);
    EXPECT_EQ(excludeClosedAir(*piece->volume, air, thickness), 0u);
}

TEST(OpenAir, IsTheSameOnAnyNumberOfThreads) {
    const auto piece = hollowBall(10.f);
    const auto leaves = piece->volume->leafCount();
    std::vector<OpenAir::Mask> first;
    for (const std::size_t threads : {1, 2, 4})
        test::onThreads(threads, [&] {
            const OpenAir air(*piece->volume);
            std::vector<OpenAir::Mask> masks;
            for (std::size_t n = 0; n < leaves; ++n)
                masks.push_back(air.sealed(n));
            if (first.empty())
                first = masks;
            EXPECT_EQ(masks, first) << threads;
        });
}

TEST(OpenAir, OfARegionIsOpenWhereItTouchesASideOfTheBox) {
    // The box's side cuts the hollow: what is seen of it goes on beyond.
    const auto piece = hollowBall(8.f);
    ASSERT_TRUE(OpenAir(*piece->volume).anyClosed());
    NestGrids& grids = piece->volume->grids();
    grids.sides = grids.space.index(Imath::Box3i(Imath::V3i(-40), Imath::V3i(40, 40, 5)));
    EXPECT_FALSE(OpenAir(*piece->volume).anyClosed());
    grids.sides = grids.space.index(Imath::Box3i(Imath::V3i(-40), Imath::V3i(40, 40, 15)));
    EXPECT_TRUE(OpenAir(*piece->volume).anyClosed());
}

TEST(OpenAir, DISABLED_TakesAtMost50MillisecondsForThreeMillionVoxels) {
    const auto piece = test::makePiece(test::sphere(172.f, 6), test::voxelScale());
    const auto start = std::chrono::steady_clock::now();
    const OpenAir air(*piece->volume);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%zu voxels: %.1f ms\n", piece->volume->activeVoxels(), 1e3 * seconds);
    EXPECT_LT(seconds, 0.05);
}

} // namespace
} // namespace patina
