// After the band has grown, voxels are bound as if they had been bound all at once.

#include "operators/coat.h"
#include "support/test_surfaces.h"
#include "volume/band.h"
#include "volume/surface_binding.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

void expectBoundAsAnew(const test::Piece& piece) {
    const SurfaceBinding fresh(*piece.volume, piece.surface, piece.closed);
    const std::size_t count = piece.volume->activeVoxels();
    ASSERT_EQ(fresh.leafStart(piece.volume->leafCount()), count);
    std::size_t bound = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const SurfacePoint &a = piece.binding->at(i), &b = fresh.at(i);
        ASSERT_EQ(a.triangle, b.triangle) << i;
        ASSERT_EQ(a.u, b.u);
        ASSERT_EQ(a.v, b.v);
        bound += a.triangle >= 0;
    }
    EXPECT_GT(bound, count / 4);
}

TEST(SurfaceBinding, ofAGrownBandIsWhatABindingMadeAnewWouldBe) {
    for (const bool open : {false, true}) { // a sheet's back is bound to nothing
        const auto piece =
            test::makePiece(open ? test::sheet(24.f, 12) : test::sphere(12.f, 3), test::voxelScale(), 3.0);
        const std::size_t before = piece->volume->activeVoxels();
        Workpiece work = piece->work();
        coat(work, "soot", 6.0, nullptr, piece->progress);
        EXPECT_GT(piece->volume->activeVoxels(), before);
        expectBoundAsAnew(*piece);
    }
}

} // namespace
} // namespace patina
