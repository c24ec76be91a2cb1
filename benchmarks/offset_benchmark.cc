// Coats and closings by whole voxels against OpenVDB's own operators on copies of the same grids, in turn with them.

#include "operators/coat.h"
#include "operators/offset.h"

#include "support/exact_volume.h"
#include "support/statue.h"

#include <benchmark/benchmark.h>
#include <openvdb/tools/LevelSetFilter.h>

#include <chrono>

namespace patina {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// A coat of four voxels on a film on a sphere. Argument: the sphere's radius in voxels (150: 3 M voxels of band).
void CoatFourVoxels(benchmark::State& state) {
    const auto piece = test::makePiece(test::sphere(static_cast<float>(state.range(0)), 6), test::voxelScale(), 8.0);
    Workpiece start = piece->work();
    coat(start, "first", 0.5, nullptr, piece->progress);
    double coatSeconds = 0.0, librarySeconds = 0.0;
    for (auto _ : state) {
        LayerVolume volume = piece->volume->clone();
        Workpiece work{volume, *piece->binding};
        auto begin = Clock::now();
        coat(work, "second", 4.0, nullptr, piece->progress);
        coatSeconds += secondsSince(begin);
        state.SetIterationTime(secondsSince(begin));
        const auto grid = piece->volume->grids().surface().deepCopy();
        begin = Clock::now();
        openvdb::tools::LevelSetFilter<openvdb::FloatGrid>(*grid).offset(-4.f);
        librarySeconds += secondsSince(begin);
    }
    state.counters["coat_ms"] = 1e3 * coatSeconds / double(state.iterations());
    state.counters["library_ms"] = 1e3 * librarySeconds / double(state.iterations());
    state.counters["ratio"] = librarySeconds / coatSeconds;
    state.counters["voxels"] = double(piece->volume->activeVoxels());
}
BENCHMARK(CoatFourVoxels)
    ->Arg(60)
    ->Arg(150)
    ->ArgName("radius")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

// offset by a ball of eight voxels against the steps that vdb_tool -close takes: LevelSetFilter out and in by the
// radius, fifth-order WENO in space and first order in time. Arguments: voxels along the longest side; whether the
// library runs.
void OffsetEightVoxels(benchmark::State& state) {
    const auto piece = test::makeStatue(static_cast<int>(state.range(0)));
    if (!piece) {
        state.SkipWithError("the Happy Buddha is not beside the project");
        return;
    }
    const double radius = 8.0 * piece->volume->scale().voxelSize;
    double offsetSeconds = 0.0, librarySeconds = 0.0;
    for (auto _ : state) {
        LayerVolume volume = piece->volume->clone();
        Workpiece work{volume, *piece->binding};
        Progress progress;
        auto begin = Clock::now();
        offset(work, "wax", radius, false, progress);
        const double seconds = secondsSince(begin);
        offsetSeconds += seconds;
        state.SetIterationTime(seconds);
        if (state.range(1)) {
            const auto grid = piece->volume->grids().surface().deepCopy();
            begin = Clock::now();
            openvdb::tools::LevelSetFilter<openvdb::FloatGrid> filter(*grid);
            filter.offset(static_cast<float>(-radius));
            filter.offset(static_cast<float>(radius));
            librarySeconds += secondsSince(begin);
        }
    }
    state.counters["offset_ms"] = 1e3 * offsetSeconds / double(state.iterations());
    state.counters["voxels"] = double(piece->volume->activeVoxels());
    if (state.range(1)) {
        state.counters["library_ms"] = 1e3 * librarySeconds / double(state.iterations());
        state.counters["ratio"] = librarySeconds / offsetSeconds;
    }
}
BENCHMARK(OffsetEightVoxels)
    ->Args({256, 0})
    ->Args({256, 1})
    ->Args({512, 1})
    ->ArgNames({"voxels", "library"})
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
