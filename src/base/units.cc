#include "base/units.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace patina {

std::optional<double> micrometresPerUnit(std::string_view unit) {
    static constexpr std::array<std::pair<std::string_view, double>, 6> units = {
        {{"nm", 1e-3}, {"um", 1.0}, {"µm", 1.0}, {"mm", 1e3}, {"cm", 1e4}, {"m", 1e6}}};
    for (const auto& [name, micrometres] : units)
        if (name == unit)
            return micrometres;
    return std::nullopt;
}

std::string readableLength(double micrometres) {
    const double size = std::abs(micrometres);
    if (size == 0.0)
        return "0 µm";
    if (size < 0.1)
        return fmt::format("{:.3g} nm", micrometres * 1e3);
    if (size < 1e3)
        return fmt::format("{:.3g} µm", micrometres);
    if (size < 1e4)
        return fmt::format("{:.3g} mm", micrometres * 1e-3);
    if (size < 1e6)
        return fmt::format("{:.3g} cm", micrometres * 1e-4);
    return fmt::format("{:.4g} m", micrometres * 1e-6);
}

std::string readableBytes(double bytes) {
    static constexpr std::array<const char*, 5> names = {"B", "KiB", "MiB", "GiB", "TiB"};
    std::size_t index = 0;
    while (bytes >= 1024.0 && index + 1 < names.size()) {
        bytes /= 1024.0;
        ++index;
    }
    return fmt::format("{:.3g} {}", bytes, names[index]);
}

} // namespace patina
