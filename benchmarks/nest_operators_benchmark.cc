// Fill, polish and erode below a voxel against OpenVDB's own operators on the same grids in the same run.
//
// The rate is that of the nest: active voxels times its level sets (floor and interfaces), per second, everything that
// an operator does included (dropping layers, IDs). OpenVDB's csgUnion and csgIntersection make of two level sets one,
// as fill and polish do with each interface; they work on copies, which are not timed.

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/polish.h"

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <benchmark/benchmark.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetFilter.h>

#include <chrono>
#include <ctime>

namespace patina {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// A sphere of 3 M band voxels under four films of 2 … 16 µm (a statue of 20 cm at 512 voxels), made once.
test::Piece& filmedSphere() {
    static const auto piece = [] {
        auto made = test::makePiece(test::sphere(172.f, 7), test::voxelScale());
        Workpiece work = made->work();
        const test::FunctionMap map([](const MapPoint& point) { return 0.5 + 0.5 * std::sin(0.1 * point.position.x); });
        coat(work, "tarnish_1", 0.005, nullptr, made->progress);
        coat(work, "cuprite_2", 0.03, nullptr, made->progress);
        coat(work, "patina", 0.04, &map, made->progress);
        coat(work, "dirt", 0.01, nullptr, made->progress);
        return made;
    }();
    return *piece;
}

// The base moved by a thickness: the other operand of OpenVDB's operators.
openvdb::FloatGrid::Ptr movedBase(const LayerVolume& volume, float by) {
    auto moved = volume.grids().base->deepCopy();
    for (FloatLeaf* leaf : leavesOf(moved->tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            voxel.setValue(*voxel - by);
    return moved;
}

template <typename Ours, typename Theirs>
void compare(benchmark::State& state, Ours ours, Theirs theirs) {
    test::Piece& piece = filmedSphere();
    double seconds = 0.0, processor = 0.0, theirSeconds = 0.0, voxelInterfaces = 0.0;
    for (auto _ : state) {
        LayerVolume volume = piece.volume->clone();
        Workpiece work{volume, *piece.binding};
        const double interfaces = volume.layerCount() + 1.0;
        const std::clock_t processorStart = std::clock();
        const auto start = Clock::now();
        ours(work, piece.progress);
        const double taken = secondsSince(start);
        seconds += taken;
        processor += double(std::clock() - processorStart) / CLOCKS_PER_SEC; // of all threads
        voxelInterfaces += double(piece.volume->activeVoxels()) * interfaces;
        if (state.range(0) != 0)
            theirSeconds += theirs(piece);
        state.SetIterationTime(taken);
    }
    state.counters["Mvoxel_interfaces_per_s"] = voxelInterfaces / seconds * 1e-6;
    state.counters["processor_ns"] = processor / voxelInterfaces * 1e9; // for one voxel of one interface
    if (state.range(0) != 0) {
        state.counters["openvdb_ms"] = theirSeconds / double(state.iterations()) * 1e3;
        state.counters["times_openvdb"] = theirSeconds / seconds;
    }
    state.counters["Mvoxels"] = double(piece.volume->activeVoxels()) * 1e-6;
}

// csgUnion of the surface, or csgIntersection of every interface, with the moved base.
double unionSeconds(const test::Piece& piece) {
    auto surface = piece.volume->grids().surface().deepCopy();
    auto moved = movedBase(*piece.volume, 0.07f);
    const auto start = Clock::now();
    openvdb::tools::csgUnion(*surface, *moved, /*prune=*/false);
    return secondsSince(start);
}

double intersectionSeconds(const test::Piece& piece) {
    double seconds = 0.0;
    for (const auto& interface : piece.volume->grids().interfaces) {
        auto grid = interface->deepCopy();
        auto moved = movedBase(*piece.volume, 0.05f);
        const auto start = Clock::now();
        openvdb::tools::csgIntersection(*grid, *moved, /*prune=*/false);
        seconds += secondsSince(start);
    }
    return seconds;
}

double offsetSeconds(const test::Piece& piece) {
    double seconds = 0.0;
    for (const auto& interface : piece.volume->grids().interfaces) {
        auto grid = interface->deepCopy();
        const auto start = Clock::now();
        openvdb::tools::LevelSetFilter<openvdb::FloatGrid>(*grid).offset(0.025f);
        seconds += secondsSince(start);
        break; // one is enough to wait for; the others take as long
    }
    return seconds * double(piece.volume->grids().interfaces.size());
}

void FillBelowAVoxel(benchmark::State& state) {
    compare(
        state, [](Workpiece& work, Progress& progress) { fill(work, "wax", 0.07, nullptr, progress); }, unionSeconds);
}
void FillSameMaterial(benchmark::State& state) {
    compare(
        state, [](Workpiece& work, Progress& progress) { fill(work, "dirt", 0.07, nullptr, progress); }, unionSeconds);
}
void PolishBelowAVoxel(benchmark::State& state) {
    compare(
        state, [](Workpiece& work, Progress& progress) { polish(work, 0.05, nullptr, progress); }, intersectionSeconds);
}
void ErodeBelowAVoxel(benchmark::State& state) {
    compare(
        state, [](Workpiece& work, Progress& progress) { erode(work, 0.025, nullptr, {}, progress); }, offsetSeconds);
}
void ErodeByHardness(benchmark::State& state) {
    compare(
        state,
        [](Workpiece& work, Progress& progress) {
            erode(work, 0.025, nullptr, {1.0, 2.0, 0.5, 1.5}, progress);
        },
        offsetSeconds);
}
// library:0 leaves OpenVDB's operator out.
BENCHMARK(FillBelowAVoxel)->ArgName("library")->Arg(0)->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(FillSameMaterial)->ArgName("library")->Arg(0)->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(PolishBelowAVoxel)->ArgName("library")->Arg(0)->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(ErodeBelowAVoxel)->ArgName("library")->Arg(0)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(ErodeByHardness)->ArgName("library")->Arg(0)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(ErodeBelowAVoxel)->ArgName("library")->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK(ErodeByHardness)->ArgName("library")->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(3);

} // namespace
} // namespace patina
