// From thicknesses to colours: what every texel and pixel costs, and what else it could have cost.

// Vectors wider than the baseline's stay inside functions that are built for them.
#pragma GCC diagnostic ignored "-Wpsabi"

#include "base/random.h"
#include "optics/band_lanes.h"
#include "optics/kubelka_munk.h"
#include "optics/layer_optics.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr int pointCount = 1024, layerCount = 4;
const char* const layerNames[layerCount] = {"tarnish_1", "cuprite_2", "marine_patina_3", "marine_patina_4"};

const MaterialLibrary& materials() {
    static const MaterialLibrary library = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    return library;
}

// Thicknesses of the marine script's range; all four layers are there at every point.
const std::vector<std::array<float, layerCount>>& marineStacks() {
    static const auto stacks = [] {
        const double most[] = {0.35, 1.2, 3.0, 1.8};
        const KeyedRandom random(1, "optics", "benchmark");
        std::vector<std::array<float, layerCount>> um(pointCount);
        for (int i = 0; i < pointCount; ++i) {
            const auto u = random.uniforms(0, i, 0, 0);
            for (int k = 0; k < layerCount; ++k)
                um[i][k] = static_cast<float>(most[k] * (0.02 + 0.98 * u[k]));
        }
        return um;
    }();
    return stacks;
}

StackOptics marineOptics(OpticsModel model = OpticsModel::energyConserving) {
    std::vector<const Material*> stack = {&materials().at("copper")};
    for (const char* name : layerNames)
        stack.push_back(&materials().at(name));
    return StackOptics(stack, model);
}

void StackToRgb(benchmark::State& state) {
    const StackOptics optics = marineOptics(state.range(0) == 1 ? OpticsModel::paper : OpticsModel::energyConserving);
    const auto& um = marineStacks();
    Appearance look;
    int i = 0;
    for (auto _ : state) {
        optics.evaluate(um[i].data(), look);
        benchmark::DoNotOptimize(look.diffuse);
        i = (i + 1) % pointCount;
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(StackToRgb)->Arg(0)->Arg(1)->ArgName("paper")->Threads(1)->Threads(2)->UseRealTime();

// Kubelka and Munk's fold alone in sixteen bands, exponentials as they ship.
void StackBody(benchmark::State& state) {
    const StackOptics optics = marineOptics();
    const auto& um = marineStacks();
    int i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(optics.bodyReflectance(um[i].data()));
        i = (i + 1) % pointCount;
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(StackBody)->Threads(1)->Threads(2)->UseRealTime();

// ---- Kubelka and Munk's fold from tables in thickness
// -----------------------------------------------------------------

/// R0 and T² - R0² of one material by log2 of the thickness, 2^-10 … 2^7 µm: R <- (R0 + (T² - R0²) R) / (1 - R0 R).
struct ThicknessTable {
    static constexpr int first = -10, octaves = 17;
    int perOctave;
    std::vector<std::array<Spectrum, 2>> entries;

    ThicknessTable(const Material& material, int steps) : perOctave(steps) {
        for (int i = 0; i <= octaves * perOctave; ++i) {
            const double um = std::exp2(first + static_cast<double>(i) / perOctave);
            std::array<Spectrum, 2> entry;
            for (int b = 0; b < bandCount; ++b) {
                const auto layer = kubelkaMunkLayer<double>(material.absorption[b], material.scattering[b], um);
                entry[0][b] = static_cast<float>(layer.reflectance);
                entry[1][b] = static_cast<float>(layer.transmittance * layer.transmittance -
                                                 layer.reflectance * layer.reflectance);
            }
            entries.push_back(entry);
        }
    }
};

struct TabledStack {
    std::vector<ThicknessTable> tables;
    const Spectrum* base;
};

template <int width>
PATINA_INLINE void foldTabled(const TabledStack& stack, const float* um, Spectrum& result) {
    using Bands = BandLanes<width>;
    Bands over = Bands::load(*stack.base), under = Bands::constant(1.f);
    for (int k = 0; k < layerCount; ++k) {
        const ThicknessTable& table = stack.tables[k];
        const float last = static_cast<float>(table.entries.size() - 2);
        const float position =
            std::clamp((std::log2(um[k]) - ThicknessTable::first) * static_cast<float>(table.perOctave), 0.f, last);
        const int below = static_cast<int>(position);
        const float weight = position - static_cast<float>(below);
        const auto &a = table.entries[below], &b = table.entries[below + 1];
        const Bands r0 = Bands::load(a[0]) + (Bands::load(b[0]) - Bands::load(a[0])) * weight;
        const Bands rest = Bands::load(a[1]) + (Bands::load(b[1]) - Bands::load(a[1])) * weight;
        const Bands next = r0 * under + rest * over;
        under = under - r0 * over;
        over = next;
    }
    (over / under).store(result);
}

// ---- three channels, a vector of points at a time
// ---------------------------------------------------------------------

struct ThreeChannels {
    float twoKappa[3][layerCount], scattering[3][layerCount], twoAbsorption[3][layerCount], minusOnePlus[3][layerCount],
        minusOneMinus[3][layerCount], base[3];
};

/// The shipping fold for sixteen points in one channel: `um` has sixteen thicknesses of each layer in a row.
template <int width>
PATINA_INLINE void foldPoints(const ThreeChannels& stack, const std::array<Spectrum, layerCount>& um,
                              std::array<Spectrum, 3>& result) {
    using Points = BandLanes<width>;
    for (int c = 0; c < 3; ++c) {
        Points back = Points::constant(stack.base[c]), lost = Points::constant(1.f - stack.base[c]);
        for (int k = 0; k < layerCount; ++k) {
            const Points h = halfGone(Points::load(um[k]) * stack.twoKappa[c][k]);
            const Points next = back * fused(h, stack.minusOnePlus[c][k], 1.f) + lost * (h * stack.scattering[c][k]);
            lost = lost * fused(h, stack.minusOneMinus[c][k], 1.f) + back * (h * stack.twoAbsorption[c][k]);
            back = next;
        }
        (back / (back + lost)).store(result[c]);
    }
}

using TabledFold = void (*)(const TabledStack&, const float*, Spectrum&);
using PointsFold = void (*)(const ThreeChannels&, const std::array<Spectrum, layerCount>&, std::array<Spectrum, 3>&);

#if defined(__x86_64__)
__attribute__((target("avx512f"))) void tabled16(const TabledStack& s, const float* um, Spectrum& r) {
    foldTabled<16>(s, um, r);
}
__attribute__((target("avx2"))) void tabled8(const TabledStack& s, const float* um, Spectrum& r) {
    foldTabled<8>(s, um, r);
}
__attribute__((target("avx512f"))) void points16(const ThreeChannels& s, const std::array<Spectrum, layerCount>& um,
                                                 std::array<Spectrum, 3>& r) {
    foldPoints<16>(s, um, r);
}
__attribute__((target("avx2"))) void points8(const ThreeChannels& s, const std::array<Spectrum, layerCount>& um,
                                             std::array<Spectrum, 3>& r) {
    foldPoints<8>(s, um, r);
}
#endif
void tabled4(const TabledStack& s, const float* um, Spectrum& r) {
    foldTabled<4>(s, um, r);
}
void points4(const ThreeChannels& s, const std::array<Spectrum, layerCount>& um, std::array<Spectrum, 3>& r) {
    foldPoints<4>(s, um, r);
}

/// The build of a loop that the machine's registers allow, as stack_kernel.cc chooses.
template <typename Fold>
Fold widest(Fold sixteen, Fold eight, Fold four) {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f"))
        return sixteen;
    if (__builtin_cpu_supports("avx2"))
        return eight;
#endif
    return four;
}
#if !defined(__x86_64__)
constexpr auto tabled16 = tabled4, tabled8 = tabled4;
constexpr auto points16 = points4, points8 = points4;
#endif

void StackBodyFromTables(benchmark::State& state) {
    const int perOctave = static_cast<int>(state.range(0));
    TabledStack stack{{}, &materials().at("copper").reflectance};
    for (const char* name : layerNames)
        stack.tables.emplace_back(materials().at(name), perOctave);
    const auto& um = marineStacks();
    const TabledFold fold = widest<TabledFold>(tabled16, tabled8, tabled4);
    const StackOptics optics = marineOptics();
    float worst = 0.f;
    Spectrum result;
    for (const auto& point : um) {
        fold(stack, point.data(), result);
        const Spectrum exact = optics.bodyReflectance(point.data());
        for (int b = 0; b < bandCount; ++b)
            worst = std::max(worst, std::abs(result[b] - exact[b]));
    }
    int i = 0;
    for (auto _ : state) {
        fold(stack, um[i].data(), result);
        benchmark::DoNotOptimize(result);
        i = (i + 1) % pointCount;
    }
    state.SetItemsProcessed(state.iterations());
    state.counters["worst_error"] = benchmark::Counter(worst, benchmark::Counter::kAvgThreads);
    state.counters["table_kB"] = benchmark::Counter(
        layerCount * static_cast<double>(stack.tables[0].entries.size() * sizeof(stack.tables[0].entries[0])) / 1024,
        benchmark::Counter::kAvgThreads);
}
BENCHMARK(StackBodyFromTables)->Arg(16)->Arg(64)->ArgName("per_octave")->Threads(1)->Threads(2)->UseRealTime();

// What a program of three channels would do at best: the fold alone, without lobes, air or energy, sixteen points in a
// vector instruction.
void ThreeChannelVector(benchmark::State& state) {
    const int bands[] = {11, 7, 2};
    ThreeChannels stack{};
    for (int c = 0; c < 3; ++c) {
        stack.base[c] = materials().at("copper").reflectance[bands[c]];
        for (int k = 0; k < layerCount; ++k) {
            const Material& m = materials().at(layerNames[k]);
            const LayerOptics optics = LayerOptics::of(m.absorption[bands[c]], m.scattering[bands[c]]);
            stack.twoKappa[c][k] = optics.twoKappa;
            stack.scattering[c][k] = optics.scattering;
            stack.twoAbsorption[c][k] = optics.twoAbsorption;
            stack.minusOnePlus[c][k] = optics.minusOnePlus;
            stack.minusOneMinus[c][k] = optics.minusOneMinus;
        }
    }
    std::vector<std::array<Spectrum, layerCount>> um(pointCount / bandCount);
    for (int i = 0; i < pointCount; ++i)
        for (int k = 0; k < layerCount; ++k)
            um[i / bandCount][k][i % bandCount] = marineStacks()[i][k];
    const PointsFold fold = widest<PointsFold>(points16, points8, points4);
    std::array<Spectrum, 3> rgb;
    std::size_t i = 0;
    for (auto _ : state) {
        fold(stack, um[i], rgb);
        benchmark::DoNotOptimize(rgb);
        i = (i + 1) % um.size();
    }
    state.SetItemsProcessed(state.iterations() * bandCount);
}
BENCHMARK(ThreeChannelVector)->Threads(1)->Threads(2)->UseRealTime();

// The same written plainly, one point and one channel after the other.
void ThreeChannelPlain(benchmark::State& state) {
    const Material& copper = materials().at("copper");
    const Material* layers[layerCount];
    for (int k = 0; k < layerCount; ++k)
        layers[k] = &materials().at(layerNames[k]);
    const int bands[] = {11, 7, 2};
    const auto& um = marineStacks();
    std::size_t i = 0;
    for (auto _ : state) {
        float rgb[3];
        for (int c = 0; c < 3; ++c) {
            float r = copper.reflectance[bands[c]];
            for (int k = 0; k < layerCount; ++k)
                r = overBackground(
                    kubelkaMunkLayer<float>(layers[k]->absorption[bands[c]], layers[k]->scattering[bands[c]], um[i][k]),
                    r);
            rgb[c] = r;
        }
        benchmark::DoNotOptimize(rgb);
        i = (i + 1) % um.size();
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ThreeChannelPlain)->Threads(1)->Threads(2)->UseRealTime();

} // namespace
} // namespace patina
