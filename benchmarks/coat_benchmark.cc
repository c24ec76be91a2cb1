// A coat by a thin film against OpenVDB's own offset of a level set.

#include "operators/coat.h"

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <benchmark/benchmark.h>
#include <openvdb/tools/LevelSetFilter.h>

#include <chrono>

namespace patina {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double filmVoxels = 0.3;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void CoatThinFilm(benchmark::State& state) {
    const auto piece = test::makePiece(test::sphere(60.f, 5), test::voxelScale());
    if (state.range(0) == 1) {
        Workpiece work = piece->work();
        coat(work, "first", 0.2, nullptr, piece->progress);
        coat(work, "second", 0.2, nullptr, piece->progress);
    }
    double coatSeconds = 0.0, offsetSeconds = 0.0;
    for (auto _ : state) {
        LayerVolume volume = piece->volume->clone();
        Workpiece work{volume, *piece->binding};
        auto start = Clock::now();
        coat(work, "film", filmVoxels, nullptr, piece->progress);
        const double seconds = secondsSince(start);
        coatSeconds += seconds;

        const auto grid = piece->volume->grids().surface().deepCopy();
        start = Clock::now();
        openvdb::tools::LevelSetFilter<openvdb::FloatGrid>(*grid).offset(static_cast<float>(-filmVoxels));
        offsetSeconds += secondsSince(start);
        state.SetIterationTime(seconds);
    }
    const double runs = double(state.iterations());
    state.counters["coat_ms"] = coatSeconds / runs * 1e3;
    state.counters["offset_ms"] = offsetSeconds / runs * 1e3;
    state.counters["ratio"] = coatSeconds / offsetSeconds;
    state.counters["voxels"] = double(piece->volume->activeVoxels());
}
BENCHMARK(CoatThinFilm)->Arg(0)->Arg(1)->ArgName("stack")->UseManualTime()->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
