// Fields over the Happy Buddha at 512 voxels (a sphere where the model is not there): accessibility, and rays of
// exposure against Embree's own rate on the same mesh and the same rays.

#include "operators/fields/accessibility.h"
#include "operators/fields/exposure.h"
#include "operators/fields/sun_and_sky.h"
#include "support/test_surfaces.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/ray_scene.h"

#include <benchmark/benchmark.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <chrono>
#include <filesystem>
#include <limits>

namespace patina {
namespace {

using Clock = std::chrono::steady_clock;

constexpr float endless = std::numeric_limits<float>::infinity();

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

const test::Piece& statue() {
    static const std::unique_ptr<test::Piece> piece = [] {
        const std::filesystem::path file =
            std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/meshes/happy_buddha_60k_uv.obj";
        SurfaceMesh surface =
            std::filesystem::exists(file) ? makeLimitSurface(readMesh(file), {}) : test::sphere(1.f, 6);
        const Imath::V3f size = surface.bounds().size();
        VolumeScale scale;
        scale.voxelSize = std::max({size.x, size.y, size.z}) / 512.0;
        return test::makePiece(std::move(surface), scale);
    }();
    return *piece;
}

void Accessibility(benchmark::State& state) {
    const LayerVolume& volume = *statue().volume;
    Progress progress;
    std::size_t voxels = 0;
    for (auto _ : state) {
        const SurfaceVoxels surface = findSurfaceVoxels(volume, 0);
        benchmark::DoNotOptimize(
            accessibleRadii(volume, surface, 0, static_cast<double>(state.range(0)), state.range(1) != 0, progress));
        voxels = surface.size();
    }
    state.counters["surface_voxels"] = static_cast<double>(voxels);
}
BENCHMARK(Accessibility)
    ->ArgNames({"radius", "global"})
    ->Args({8, 0})
    ->Args({32, 0})
    ->Args({32, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// Exposure by 256 rays a voxel, and the bare loop over the same rays.
void ExposureRays(benchmark::State& state) {
    const test::Piece& piece = statue();
    const double voxelSize = piece.volume->scale().voxelSize;
    const SurfaceVoxels surface = findSurfaceVoxels(*piece.volume, 0);
    const RayScene scene(piece.surface.positions, piece.surface.triangles);
    const LightDome dome = makeLightDome({});
    const Compass compass = Compass::from({0, 1, 0}, {0, 0, -1});
    Progress progress;
    double exposureSeconds = 0.0, embreeSeconds = 0.0, rays = 0.0;
    for (auto _ : state) {
        auto start = Clock::now();
        benchmark::DoNotOptimize(
            gatherDome(surface, voxelSize, dome, compass, Obstacles::of(scene), {}, progress));
        exposureSeconds += secondsSince(start);

        std::vector<Imath::V3f> directions;
        for (const Imath::V3d& d : dome.directions(256, DomeGatherer::sets))
            directions.emplace_back(compass.direction(d));
        start = Clock::now();
        rays += static_cast<double>(tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, surface.size()), std::size_t(0),
            [&](const auto& range, std::size_t count) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    const Imath::V3f& n = surface.normals[i];
                    const Imath::V3f o = (surface.feet[i] + n * 0.3f) * static_cast<float>(voxelSize);
                    const std::size_t set = i % DomeGatherer::sets * 256;
                    for (std::size_t r = 0; r < 256; ++r)
                        if (directions[set + r].dot(n) > 0.f) {
                            benchmark::DoNotOptimize(scene.occluded(o, directions[set + r], 0.f, endless));
                            ++count;
                        }
                }
                return count;
            },
            std::plus<>()));
        embreeSeconds += secondsSince(start);
    }
    const double runs = static_cast<double>(state.iterations());
    state.counters["surface_voxels"] = static_cast<double>(surface.size());
    state.counters["exposure_s"] = exposureSeconds / runs;
    state.counters["Mrays_per_s"] = rays / exposureSeconds * 1e-6;
    state.counters["embree_Mrays_per_s"] = rays / embreeSeconds * 1e-6;
}
BENCHMARK(ExposureRays)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

} // namespace
} // namespace patina
