#include "operators/random_operations.h"

namespace patina {
namespace {

// The first forty run by default.
TEST(ThousandSequences, KeepTheNestsInvariants) {
    test::runSequences(40, 1000);
}

} // namespace
} // namespace patina
