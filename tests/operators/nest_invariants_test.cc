#include "operators/random_operations.h"
#include "support/moved_volume.h"
#include "support/on_threads.h"

namespace patina {
namespace {

TEST(Nest, StaysNestedWithTrueIdsThroughRandomOperations) {
    test::runSequences(0, 40, {2});
}

TEST(Nest, HasTheSameBitsOnAnyNumberOfThreads) {
    for (int sequence = 100; sequence < 106; ++sequence) {
        std::string first;
        for (const std::size_t threads : {1, 2, 4})
            test::onThreads(threads, [&] {
                const auto piece = test::makePiece(test::sphere(12.f, 3), test::voxelScale(), 8.0);
                test::randomOperations(*piece, sequence);
                const std::string hash = contentHash(*piece->volume);
                if (first.empty())
                    first = hash;
                ASSERT_EQ(hash, first) << sequence << " on " << threads;
            });
    }
}

// Where the model lies around index 0 its leaves come in another order, from eight upper nodes.
TEST(Nest, HasTheSameBitsWhereverInIndexSpaceItsGridsLie) {
    for (int sequence = 200; sequence < 212; ++sequence) {
        const auto here = test::shapeOf(sequence), there = test::shapeOf(sequence);
        ASSERT_NE(here->volume->grids().space.origin(), openvdb::Coord(0));
        test::moveTo(*there, openvdb::Coord(0));
        ASSERT_EQ(contentHash(*there->volume), contentHash(*here->volume)) << sequence;
        test::randomOperations(*here, sequence);
        test::randomOperations(*there, sequence);
        ASSERT_EQ(contentHash(*there->volume), contentHash(*here->volume)) << sequence;
    }
}

} // namespace
} // namespace patina
