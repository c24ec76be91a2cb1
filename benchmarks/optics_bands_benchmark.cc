// How many bands: the table of docs/optics.md, section 2. Colours of random stacks from a few bands against 5 nm.

#include "optics/optics_test_support.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace patina {
namespace {

/// A spectrum known at evenly spaced bands, read every 5 nm through the four (or two) nearest, constant beyond the
/// ends.
FineSpectrum read(const std::vector<double>& bands, double firstNm, double lastNm, bool cubic) {
    const int count = static_cast<int>(bands.size()), points = cubic ? 4 : 2;
    const double step = (lastNm - firstNm) / (count - 1);
    FineSpectrum fine{};
    for (int i = 0; i < fineCount; ++i) {
        const double position = std::clamp((fineWavelengthNm(i) - firstNm) / step, 0.0, count - 1.0);
        const int first = std::clamp(static_cast<int>(position) - (cubic ? 1 : 0), 0, count - points);
        for (int a = 0; a < points; ++a) {
            double basis = 1.0;
            for (int b = 0; b < points; ++b)
                if (b != a)
                    basis *= (position - (first + b)) / (a - b);
            fine[i] += basis * bands[first + a];
        }
    }
    return fine;
}

double at(const FineSpectrum& fine, double nm) {
    const double position = std::clamp((nm - fineWavelengthNm(0)) / 5.0, 0.0, fineCount - 1.0);
    const int below = std::min(static_cast<int>(position), fineCount - 2);
    return fine[below] + (position - below) * (fine[below + 1] - fine[below]);
}

// Kubelka–Munk in double precision: what is measured is the bands, not the arithmetic.
void Bands(benchmark::State& state) {
    const int count = static_cast<int>(state.range(0));
    const double firstNm = static_cast<double>(state.range(1)), lastNm = static_cast<double>(state.range(2));
    constexpr int stacks = 20000;
    std::vector<double> differences;
    for (auto _ : state) {
        test::Uniforms uniforms("bands");
        differences.clear();
        std::vector<double> bands(count);
        for (int i = 0; i < stacks; ++i) {
            const test::RandomStack stack = test::randomStack(uniforms);
            for (int b = 0; b < count; ++b) {
                const double nm = firstNm + (lastNm - firstNm) * b / (count - 1);
                double r = at(stack.materials[0]->fineReflectance, nm);
                for (std::size_t k = 1; k < stack.materials.size(); ++k)
                    r = overBackground(kubelkaMunkLayer<double>(at(stack.materials[k]->fineAbsorption, nm),
                                                                at(stack.materials[k]->fineScattering, nm),
                                                                stack.thicknessUm[k - 1]),
                                       r);
                bands[b] = r;
            }
            differences.push_back(
                deltaE2000(labFromXyz(xyzFromReflectance(read(bands, firstNm, lastNm, state.range(3) == 1))),
                           labFromXyz(xyzFromReflectance(test::fineBody(stack.materials, stack.thicknessUm)))));
        }
    }
    std::sort(differences.begin(), differences.end());
    double sum = 0.0;
    for (const double d : differences)
        sum += d;
    state.counters["mean"] = sum / stacks;
    state.counters["p99"] = differences[stacks * 99 / 100];
    state.counters["worst"] = differences.back();
}
BENCHMARK(Bands)
    ->Args({8, 410, 680, 1})
    ->Args({12, 410, 680, 1})
    ->Args({16, 400, 700, 0})
    ->Args({16, 400, 700, 1})
    ->Args({16, 410, 680, 1})
    ->Args({24, 390, 710, 1})
    ->ArgNames({"bands", "first_nm", "last_nm", "cubic"})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

} // namespace
} // namespace patina
