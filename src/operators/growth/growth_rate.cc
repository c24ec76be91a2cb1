#include "operators/growth/growth_rate.h"

#include <algorithm>
#include <cmath>

namespace patina {

std::vector<std::string> growthRateNames() {
    return {"linear", "parabolic", "cubic", "logarithmic"};
}

std::optional<GrowthRate> growthRateNamed(std::string_view name) {
    if (name == "linear")
        return GrowthRate::linear;
    if (name == "parabolic")
        return GrowthRate::parabolic;
    if (name == "cubic")
        return GrowthRate::cubic;
    if (name == "logarithmic")
        return GrowthRate::logarithmic;
    return std::nullopt;
}

double growthFraction(GrowthRate rate, double x) {
    x = std::clamp(x, 0.0, 1.0);
    switch (rate) {
    case GrowthRate::linear:
        return x;
    case GrowthRate::parabolic:
        return std::sqrt(x);
    case GrowthRate::cubic:
        return std::cbrt(x);
    case GrowthRate::logarithmic:
        return std::log1p(9.0 * x) / std::log(10.0);
    }
    return x;
}

double growthAge(GrowthRate rate, double step, double total) {
    return total > 0.0 ? total * growthFraction(rate, step / total) : 0.0;
}

} // namespace patina
