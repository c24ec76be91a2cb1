#pragma once
// Work on a number of threads that may be more than the machine has cores.

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace patina::test {

/// Runs `work` in an arena of so many threads. A limit alone (tbb::global_control) would give no more than there are
/// cores: "on 4 threads" would be 2 on two cores.
template <typename Work>
void onThreads(std::size_t threads, Work work) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(static_cast<int>(threads));
    arena.execute(work);
}

} // namespace patina::test
