// From thicknesses to colours: what every texel and pixel costs.

#include "base/random.h"
#include "optics/layer_stack.h"
#include "optics/material_library.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <vector>

namespace patina {
namespace {

void StackToRgb(benchmark::State& state) {
    const MaterialLibrary materials = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
    const StackOptics optics({&materials.at("copper"), &materials.at("tarnish_1"), &materials.at("cuprite_2"),
                              &materials.at("marine_patina_3"), &materials.at("marine_patina_4")},
                             state.range(0) == 1 ? OpticsModel::paper : OpticsModel::energyConserving);
    // Thicknesses of the marine script's range, one of them absent now and then.
    constexpr int stacks = 1024;
    const double most[] = {0.35, 1.2, 3.0, 1.8};
    const KeyedRandom random(1, "optics", "benchmark");
    std::vector<std::array<float, 4>> um(stacks);
    for (int i = 0; i < stacks; ++i) {
        const auto u = random.uniforms(0, i, 0, 0);
        for (int k = 0; k < 4; ++k)
            um[i][k] = static_cast<float>(most[k] * std::max(0.0, 1.1 * u[k] - 0.1));
    }
    Appearance look;
    int i = 0;
    for (auto _ : state) {
        optics.evaluate(um[i].data(), look);
        benchmark::DoNotOptimize(look.diffuse);
        i = (i + 1) % stacks;
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(StackToRgb)->Arg(0)->Arg(1)->ArgName("paper");

} // namespace
} // namespace patina
