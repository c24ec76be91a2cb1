// Maps from a volume: texels a second, with and without the files.

#include "export/bake.h"
#include "export/map_files.h"
#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"
#include "surface/atlas.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/shapes.h"

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace patina {
namespace {

// Takes the maps and drops them.
class NoSink : public MapSink {
  public:
    void begin(const std::vector<MapInfo>&) override {}
    void write(int, const void*, int) override {}
    void end() override {}
    void finish(const std::vector<std::vector<std::pair<std::string, float>>>&) override {}
};

double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; } // of all threads

// The Happy Buddha where it lies beside the project, else a sphere, 512 voxels of 0.4 mm, under two films.
void BakesMaps(benchmark::State& state) {
    const auto file = std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/meshes/happy_buddha_60k_uv.obj";
    const int voxels = static_cast<int>(state.range(1));
    Mesh mesh;
    if (std::filesystem::exists(file)) {
        mesh = readMesh(file);
        for (Imath::V2f& uv : mesh.uvs)
            uv = {std::clamp(uv.x, 0.f, 1.f), std::clamp(uv.y, 0.f, 1.f)};
    } else {
        mesh = makeShape("sphere");
        makeFaceAtlas(mesh, static_cast<int>(state.range(0)));
    }
    LimitSurfaceOptions limit;
    limit.level = 1;
    const Imath::V3f size = makeLimitSurface(mesh, limit).bounds().size();
    VolumeScale scale;
    scale.voxelSize = std::max({size.x, size.y, size.z}) / voxels;
    scale.metresPerUnit = 4e-4 / scale.voxelSize;
    limit.level = -1;
    limit.targetEdge = 1.5 * scale.voxelSize;
    const auto piece = test::makePiece(makeLimitSurface(mesh, limit), scale);
    auto work = piece->work();
    coat(work, "tarnish_1", 0.35, nullptr, piece->progress);
    coat(work, "cuprite_2", 5.0, nullptr, piece->progress);
    const MaterialLibrary library = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    const StackOptics optics({&library.at("copper"), &library.at("tarnish_1"), &library.at("cuprite_2")});
    BakeOptions options;
    options.resolution = static_cast<int>(state.range(0));
    const bool files = state.range(2) != 0;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("patina_bake_benchmark_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    double texels = 0.0;
    const double before = processorSeconds();
    for (auto _ : state) {
        if (files) {
            MapFiles sink(folder, {});
            texels += static_cast<double>(
                bakeInto(sink, *piece->volume, piece->surface, optics, options, piece->progress).texels);
            sink.commit();
        } else {
            NoSink sink;
            texels += static_cast<double>(
                bakeInto(sink, *piece->volume, piece->surface, optics, options, piece->progress).texels);
        }
    }
    std::filesystem::remove_all(folder);
    state.counters["Mtexel_per_s"] = benchmark::Counter(texels * 1e-6, benchmark::Counter::kIsRate);
    state.counters["Mtexel_per_processor_s"] = texels * 1e-6 / (processorSeconds() - before);
}
BENCHMARK(BakesMaps)
    ->Name("Bake")
    ->ArgNames({"resolution", "voxels", "files"})
    ->Args({1024, 128, 0})
    ->Args({1024, 128, 1})
    ->Args({4096, 512, 0})
    ->Args({4096, 512, 1})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

} // namespace
} // namespace patina
