// From thicknesses to colours: what every texel and pixel costs.

#include "base/random.h"
#include "optics/kubelka_munk.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <vector>

namespace patina {
namespace {

// Thicknesses of the marine script's range, one of them absent now and then.
std::vector<std::array<float, 4>> marineStacks() {
    const double most[] = {0.35, 1.2, 3.0, 1.8};
    const KeyedRandom random(1, "optics", "benchmark");
    std::vector<std::array<float, 4>> um(1024);
    for (std::size_t i = 0; i < um.size(); ++i) {
        const auto u = random.uniforms(0, int(i), 0, 0);
        for (int k = 0; k < 4; ++k)
            um[i][k] = static_cast<float>(most[k] * std::max(0.0, 1.1 * u[k] - 0.1));
    }
    return um;
}

void StackToRgb(benchmark::State& state) {
    const MaterialLibrary materials = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    const StackOptics optics({&materials.at("copper"), &materials.at("tarnish_1"), &materials.at("cuprite_2"),
                              &materials.at("marine_patina_3"), &materials.at("marine_patina_4")},
                             state.range(0) == 1 ? OpticsModel::paper : OpticsModel::energyConserving);
    const auto um = marineStacks();
    Appearance look;
    int i = 0;
    for (auto _ : state) {
        optics.evaluate(um[i].data(), look);
        benchmark::DoNotOptimize(look.diffuse);
        i = (i + 1) % int(um.size());
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(StackToRgb)->Arg(0)->Arg(1)->ArgName("paper")->Threads(1)->Threads(2)->UseRealTime();

// What a program of three channels would do: Kubelka and Munk's fold alone, without lobes, air or energy.
void ThreeChannelStack(benchmark::State& state) {
    const MaterialLibrary materials = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    const Material* layers[] = {&materials.at("tarnish_1"), &materials.at("cuprite_2"),
                                &materials.at("marine_patina_3"), &materials.at("marine_patina_4")};
    const Material& copper = materials.at("copper");
    const int bands[] = {11, 7, 2};
    const auto um = marineStacks();
    std::size_t i = 0;
    for (auto _ : state) {
        float rgb[3];
        for (int c = 0; c < 3; ++c) {
            float r = copper.reflectance[bands[c]];
            for (int k = 0; k < 4; ++k)
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
BENCHMARK(ThreeChannelStack)->Threads(1)->Threads(2)->UseRealTime();

} // namespace
} // namespace patina
