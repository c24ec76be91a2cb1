#include "operators/random_operations.h"
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

} // namespace
} // namespace patina
