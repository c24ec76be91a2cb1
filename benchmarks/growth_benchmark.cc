// Particles landing on a plate, on a statue, and in the plainest program there is.

#include "operators/growth/grow.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/shapes.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <random>

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

// On the Happy Buddha (a sphere where it is not at hand), cells of 1/512 of its longest side.
void DepositsOnStatue(benchmark::State& state, GrowthModel model) {
    const std::string file = PATINA_SOURCE_DIR "/../shared/data/meshes/happy_buddha_60k_uv.obj";
    const SurfaceMesh surface =
        makeLimitSurface(std::filesystem::exists(file) ? readMesh(file) : makeShape("sphere"), {});
    const Imath::V3f size = surface.bounds().size();
    const GrowthLattice lattice = surfaceLattice(surface, std::max({size.x, size.y, size.z}) / 512.0);
    GrowthOptions options;
    options.model = model;
    options.step = options.total = 20;
    const auto particles = double(grow(lattice, options, 1, "statue").statistics.particles);
    for (auto _ : state)
        benchmark::DoNotOptimize(growHeights(lattice, options, 1, "statue").data());
    state.counters["particles"] = particles;
    state.SetItemsProcessed(static_cast<std::int64_t>(particles) * state.iterations());
}
BENCHMARK_CAPTURE(DepositsOnStatue, RD, GrowthModel::randomDeposition)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(DepositsOnStatue, RDR, GrowthModel::relaxation)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(DepositsOnStatue, BD, GrowthModel::ballisticDeposition)->UseRealTime()->Unit(benchmark::kMillisecond);

// What a plain program does on a height field of the same size: one random site after the other.
void PlainHeightField(benchmark::State& state, bool ballistic) {
    constexpr int side = 512, particles = 20 * side * side;
    for (auto _ : state) {
        std::mt19937 random(1);
        std::vector<int> height(side * side, 0);
        const auto at = [&](int x, int y) -> int& { return height[(x & (side - 1)) * side + (y & (side - 1))]; };
        for (int i = 0; i < particles; ++i) {
            const unsigned site = random() & (side * side - 1);
            const int x = int(site / side), y = int(site % side);
            int& here = at(x, y);
            here = ballistic ? std::max({here + 1, at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)}) : here + 1;
        }
        benchmark::DoNotOptimize(height.data());
    }
    state.SetItemsProcessed(std::int64_t(particles) * state.iterations());
}
BENCHMARK_CAPTURE(PlainHeightField, RD, false)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(PlainHeightField, BD, true)->UseRealTime()->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
