#include "operators/random_operations.h"

namespace patina {
namespace {

TEST(ThousandSequences, KeepTheNestsInvariantsAndHaveTheSameBitsOnAnyNumberOfThreads) {
    test::runSequences(0, 1000, {1, 2, 4});
}

} // namespace
} // namespace patina
