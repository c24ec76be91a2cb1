// Particles landing on a plate.

#include "operators/growth/grow.h"

#include <benchmark/benchmark.h>

namespace patina {
namespace {

void Deposits(benchmark::State& state, GrowthModel model) {
    const GrowthLattice plate = flatLattice(512, 512, true);
    GrowthOptions options;
    options.model = model;
    options.step = options.total = 20;
    // Counted apart: the factors that grow() makes too cost a reference plane.
    const auto particles = double(grow(plate, options, 1, "plate").statistics.particles);
    for (auto _ : state)
        benchmark::DoNotOptimize(growHeights(plate, options, 1, "plate").data());
    state.counters["particles"] = particles;
    state.SetItemsProcessed(static_cast<std::int64_t>(particles) * state.iterations());
}
BENCHMARK_CAPTURE(Deposits, RD, GrowthModel::randomDeposition)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Deposits, BD, GrowthModel::ballisticDeposition)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Deposits, DPD, GrowthModel::directedPercolation)->UseRealTime()->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
