#pragma once
// How old a pattern is at a step of a total.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patina {

/// Growth rates of the paper (section 3.3; parabolic oxidation: Wagner; cubic and logarithmic: thin films).
enum class GrowthRate { linear, parabolic, cubic, logarithmic };

/// "linear", "parabolic", "cubic", "logarithmic".
std::optional<GrowthRate> growthRateNamed(std::string_view name);
std::vector<std::string> growthRateNames();

/// g(x) on 0…1, g(0) = 0, g(1) = 1: x, √x, ∛x, ln(1+9x)/ln 10. x is clamped to 0…1.
double growthFraction(GrowthRate rate, double x);

/// total * g(step / total): the pattern's age in monolayers, which is the number of particles that would have arrived
/// per cell. 0 for total <= 0.
double growthAge(GrowthRate rate, double step, double total);

} // namespace patina
