#pragma once
// Lengths: scripts speak micrometres, meshes speak scene units.

#include <optional>
#include <string>
#include <string_view>

namespace patina {

/// Micrometres in one of the unit: "nm", "um" (or "µm"), "mm", "cm", "m". Empty for any other word.
std::optional<double> micrometresPerUnit(std::string_view unit);

/// A length with three significant digits in the unit that reads best: "0.35 µm", "20 cm".
std::string readableLength(double micrometres);

/// A number of bytes as "1.5 GiB".
std::string readableBytes(double bytes);

} // namespace patina
