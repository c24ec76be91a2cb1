// A statue from 256 to 1024 voxels: time and memory of six layers and what follows them, against the memory formula.

#include "support/six_layers.h"
#include "support/statue.h"
#include "volume/nest_grids.h"

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <chrono>

namespace patina {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// The most memory that the process has had so far, bytes.
double peakBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * double(usage.ru_maxrss);
}

// Argument: voxels along the longest side. Run one alone where the peak matters (--benchmark_filter=…/1024): it is the
// process's, which includes the runs before.
void SixLayersOnAStatue(benchmark::State& state) {
    for (auto _ : state) {
        const double before = peakBytes();
        const auto begin = Clock::now();
        const auto piece = test::makeStatue(static_cast<int>(state.range(0)));
        if (!piece) {
            state.SkipWithError("the Happy Buddha is not beside the project");
            return;
        }
        const double voxelized = secondsSince(begin);
        test::laySixLayers(*piece, static_cast<int>(state.range(0)));
        state.SetIterationTime(secondsSince(begin));

        const NestGrids& grids = piece->volume->grids();
        const double leafVoxels = double(piece->volume->leafCount()) * 512.0;
        const double formula = 4.0 * leafVoxels * (piece->volume->layerCount() + 2.0);
        state.counters["voxelize_s"] = voxelized;
        state.counters["layers"] = piece->volume->layerCount();
        state.counters["Mvoxels"] = 1e-6 * double(piece->volume->activeVoxels());
        state.counters["grids_MB"] = 1e-6 * double(piece->volume->memoryBytes());
        state.counters["of_formula"] = double(piece->volume->memoryBytes()) / formula;
        state.counters["peak_MB"] = 1e-6 * peakBytes();
        state.counters["peak_of_formula"] = (peakBytes() - before) / (1.15 * formula);
        benchmark::DoNotOptimize(grids);
    }
}
BENCHMARK(SixLayersOnAStatue)
    ->Arg(256)
    ->Arg(512)
    ->Arg(1024)
    ->ArgName("voxels")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
