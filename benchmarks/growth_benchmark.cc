// Particles landing on a plate, on a statue, and in the plainest program there is.

#include "operators/growth/grow.h"
#include "operators/growth/voxel_growth.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/shapes.h"
#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <benchmark/benchmark.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

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
BENCHMARK_CAPTURE(Deposits, RDR, GrowthModel::relaxation)->UseRealTime()->Unit(benchmark::kMillisecond);
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

constexpr int side = 512, monolayers = 20;

// What a plain program does on a height field of the same size: one random site after the other.
void growPlainly(bool ballistic, std::vector<int>& height) {
    std::mt19937 random(1);
    height.assign(side * side, 0);
    const auto at = [&](int x, int y) -> int& { return height[(x & (side - 1)) * side + (y & (side - 1))]; };
    for (int i = 0; i < monolayers * side * side; ++i) {
        const unsigned site = random() & (side * side - 1);
        const int x = int(site / side), y = int(site % side);
        int& here = at(x, y);
        here = ballistic ? std::max({here + 1, at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)}) : here + 1;
    }
}

void PlainHeightField(benchmark::State& state, bool ballistic) {
    std::vector<int> height;
    for (auto _ : state) {
        growPlainly(ballistic, height);
        benchmark::DoNotOptimize(height.data());
    }
    state.SetItemsProcessed(std::int64_t(monolayers) * side * side * state.iterations());
}

template <class Work>
double secondsOf(Work&& work) {
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

// How much longer a keyed history takes than the plain loop, both on one thread, turn and turn about.
void TimesThePlainLoop(benchmark::State& state, GrowthModel model) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    const GrowthLattice plate = flatLattice(side, side, true);
    GrowthOptions options;
    options.model = model;
    options.step = options.total = monolayers;
    std::vector<int> height;
    double plain = 1e9, keyed = 1e9;
    for (auto _ : state) {
        plain = std::min(plain, secondsOf([&] { growPlainly(model == GrowthModel::ballisticDeposition, height); }));
        keyed = std::min(keyed, secondsOf([&] { growHeights(plate, options, 1, "plate"); }));
    }
    state.counters["times_plain"] = keyed / plain;
}
BENCHMARK_CAPTURE(TimesThePlainLoop, RD, GrowthModel::randomDeposition)->Iterations(1);
BENCHMARK_CAPTURE(TimesThePlainLoop, BD, GrowthModel::ballisticDeposition)->Iterations(1);

// A ballistic layer made of voxels on a plate: particles a second, from arrival to interface and IDs; and what memory
// that takes while it goes on, beyond what it leaves, in parts of the band (its grids).
void DepositsInVoxels(benchmark::State& state, GrowthModel model) {
    initializeVolumes();
    constexpr int voxels = 160;
    const double thickness = model == GrowthModel::ballisticDeposition ? 16.0 : 24.0;
    const double height = model == GrowthModel::ballisticDeposition ? 64.0 : thickness + 5.0;
    const auto piece = test::makePiece(test::sheet(float(voxels), 40), test::voxelScale(), height);
    const GrowthLattice lattice = surfaceLattice(piece->surface, 1.0);
    VoxelGrowth growth;
    growth.options.model = model;
    growth.options.step = growth.options.total = 20;
    growth.label = "soot";
    growth.cubes = true;
    double particles = 0.0, extra = 0.0;
    for (auto _ : state) {
        state.PauseTiming();
        LayerVolume volume = piece->volume->clone();
        Workpiece work{volume, *piece->binding};
        malloc_trim(0);
        std::ofstream("/proc/self/clear_refs") << 5; // the peak begins anew
        state.ResumeTiming();
        const auto report = coatByVoxelGrowth(work, "soot", thickness, lattice, growth, piece->progress);
        state.PauseTiming();
        particles += double(report.statistics.particles);
        const auto status = [](const char* key) {
            std::ifstream file("/proc/self/status");
            for (std::string word; file >> word;)
                if (word == key) {
                    double kib = 0.0;
                    file >> kib;
                    return kib * 1024.0;
                }
            return 0.0;
        };
        const double peak = status("VmHWM:");
        malloc_trim(0);
        const NestGrids& grids = volume.grids();
        double band = double(grids.base->memUsage() + grids.material->memUsage());
        for (const auto& interface : grids.interfaces)
            band += double(interface->memUsage());
        extra = std::max(extra, (peak - status("VmRSS:")) / band);
        state.ResumeTiming();
    }
    state.counters["peak_over_band"] = extra;
    state.SetItemsProcessed(static_cast<std::int64_t>(particles));
}
BENCHMARK_CAPTURE(DepositsInVoxels, RDR, GrowthModel::relaxation)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(DepositsInVoxels, BD, GrowthModel::ballisticDeposition)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK_CAPTURE(PlainHeightField, RD, false)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(PlainHeightField, BD, true)->UseRealTime()->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
