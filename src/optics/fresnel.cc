#include "optics/fresnel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

namespace {

constexpr int indexSteps = 300;
constexpr double lastIndex = 4.0;
using DiffuseTable = std::array<double, indexSteps + 1>;

DiffuseTable computeExternal() {
    DiffuseTable table{};
    constexpr int points = 2000;
    for (int i = 0; i <= indexSteps; ++i) {
        const double index = 1.0 + (lastIndex - 1.0) * i / indexSteps;
        // The integrand changes fast near grazing: c = u² puts the points there.
        double sum = 0.0;
        for (int p = 0; p < points; ++p) {
            const double u = (p + 0.5) / points;
            const double c = u * u;
            sum += dielectricReflectance(c, index) * c * 2.0 * u;
        }
        table[i] = 2.0 * sum / points;
    }
    return table;
}

} // namespace

double normalReflectance(double n, double k, double outside) {
    const double difference = n - outside;
    const double sum = n + outside;
    return (difference * difference + k * k) / (sum * sum + k * k);
}

double dielectricReflectance(double cosine, double eta) {
    const double c = std::clamp(cosine, 0.0, 1.0);
    const double cosine2Inside = 1.0 - (1.0 - c * c) / (eta * eta);
    if (cosine2Inside <= 0.0) {
        return 1.0;
    }
    const double inside = std::sqrt(cosine2Inside);
    const double parallel = (eta * c - inside) / (eta * c + inside);
    const double perpendicular = (c - eta * inside) / (c + eta * inside);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

DiffuseInterface diffuseInterface(double index) {
    static const DiffuseTable table = computeExternal();
    const double n = std::clamp(index, 1.0, lastIndex);
    const double position = (n - 1.0) / (lastIndex - 1.0) * indexSteps;
    const int below = std::min(static_cast<int>(position), indexSteps - 1);
    const double weight = position - below;
    const double external = (1.0 - weight) * table[below] + weight * table[below + 1];
    return {external, 1.0 - (1.0 - external) / (n * n)};
}

double saunderson(double internalReflectance, double k1, double k2) {
    return k1 + (1.0 - k1) * (1.0 - k2) * internalReflectance / (1.0 - k2 * internalReflectance);
}

double inverseSaunderson(double measuredReflectance, double k1, double k2) {
    return std::max(0.0, (measuredReflectance - k1) / (1.0 - k1 - k2 + k2 * measuredReflectance));
}

} // namespace patina
