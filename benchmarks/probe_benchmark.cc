// Reading the stack along a normal: what every texel, vertex and pixel costs.

#include "volume/stack_probe.h"

#include "operators/coat.h"
#include "support/test_surfaces.h"

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace patina {
namespace {

void StackProbeReads(benchmark::State& state) {
    const auto piece = test::makePiece(test::sphere(60.f, 5), test::voxelScale());
    Workpiece work = piece->work();
    for (int k = 0; k < state.range(0); ++k)
        coat(work, "film" + std::to_string(k), 0.1, nullptr, piece->progress);
    const StackProbe probe(*piece->volume);
    std::vector<double> um(probe.layerCount());
    const SurfaceMesh& surface = piece->surface;
    std::size_t vertex = 0;
    for (auto _ : state) {
        const auto reading =
            probe.read(Imath::V3d(surface.positions[vertex]), Imath::V3d(surface.normals[vertex]), um.data());
        benchmark::DoNotOptimize(reading.height);
        vertex = vertex + 1 == surface.positions.size() ? 0 : vertex + 1;
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(StackProbeReads)->Name("StackProbe")->Arg(1)->Arg(5)->ArgName("films");

} // namespace
} // namespace patina
