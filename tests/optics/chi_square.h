#pragma once
// Pearson's chi² of drawn directions against their density, as pbrt and Mitsuba test theirs.

#include "optics/patina_bsdf.h"
#include "optics_test_support.h"

namespace patina::test {

inline Imath::V3f direction(double cosine, double phi) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return {static_cast<float>(sine * std::cos(phi)), static_cast<float>(sine * std::sin(phi)),
            static_cast<float>(cosine)};
}

inline Imath::V3f threeUniforms(Uniforms& uniforms) {
    const float x = static_cast<float>(uniforms());
    const float y = static_cast<float>(uniforms());
    const float z = static_cast<float>(uniforms());
    return {std::min(x, 0.99999994f), std::min(y, 0.99999994f), std::min(z, 0.99999994f)};
}

/// Upper tail of the chi² distribution, Q(k / 2, x / 2): the series of the lower tail below x = k + 2, Lentz's
/// continued fraction above (Numerical Recipes §6.2).
inline double chiSquareTail(double chi2, int freedom) {
    const double a = 0.5 * freedom, x = 0.5 * chi2;
    if (!(x > 0.0)) {
        return 1.0;
    }
    const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
    if (x < a + 1.0) {
        double term = 1.0 / a, sum = term;
        for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) {
            term *= x / (a + n);
            sum += term;
        }
        return 1.0 - front * sum;
    }
    double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
    for (int n = 1; n < 10000; ++n) {
        const double an = -n * (n - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1.0) < 1e-15) {
            break;
        }
    }
    return front * h;
}

/// The chance that directions of this density deviate as much as the drawn ones do. 20 × 20 patches of the hemisphere,
/// in each the density summed at `fine`² points; patches that expect fewer than 5 are pooled, with what falls below the
/// horizon as one more.
inline double samplingPValue(const PatinaBsdf& bsdf, const Imath::V3f& wo, int samples, int fine, Uniforms& uniforms) {
    constexpr double pi = 3.14159265358979323846;
    constexpr int rows = 20, columns = 20;
    std::vector<double> counts(rows * columns, 0.0);
    double lost = 0.0;
    for (int i = 0; i < samples; ++i) {
        const BsdfSample drawn = bsdf.sample(wo, threeUniforms(uniforms));
        if (drawn.pdf <= 0.f) {
            ++lost;
            continue;
        }
        double phi = std::atan2(drawn.wi.y, drawn.wi.x);
        phi = phi < 0.0 ? phi + 2.0 * pi : phi;
        const int row = std::min(static_cast<int>(drawn.wi.z * rows), rows - 1);
        const int column = std::min(static_cast<int>(phi / (2.0 * pi) * columns), columns - 1);
        ++counts[row * columns + column];
    }
    double chi2 = 0.0, pooledExpected = 0.0, pooledCount = lost, sum = 0.0;
    int cells = 0;
    const double dc = 1.0 / rows / fine, dp = 2.0 * pi / columns / fine;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            double density = 0.0;
            for (int i = 0; i < fine; ++i) {
                for (int j = 0; j < fine; ++j) {
                    density += bsdf.pdf(wo, direction((row * fine + i + 0.5) * dc, (column * fine + j + 0.5) * dp));
                }
            }
            const double expected = samples * density * dc * dp, count = counts[row * columns + column];
            sum += expected;
            if (expected < 5.0) {
                pooledExpected += expected;
                pooledCount += count;
                continue;
            }
            chi2 += (count - expected) * (count - expected) / expected;
            ++cells;
        }
    }
    pooledExpected += samples - sum; // the density of what is lost below the horizon
    if (pooledExpected >= 5.0) {
        chi2 += (pooledCount - pooledExpected) * (pooledCount - pooledExpected) / pooledExpected;
        ++cells;
    } else if (pooledCount > std::max(pooledExpected, 0.0) + 15.0) {
        return 0.0;
    }
    return chiSquareTail(chi2, std::max(cells - 1, 1));
}

} // namespace patina::test
