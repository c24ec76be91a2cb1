#pragma once
// Arithmetic of maps: + - * / min max clamp mix pow smoothstep and constants.

#include "operators/maps/thickness_map.h"

#include <functional>
#include <vector>

namespace patina {

ThicknessMapPtr makeConstantMap(double value);

/// A function of the values of other maps at the same point; `function` gets them in order. Results that are not
/// finite (a division by zero) count as 0.
ThicknessMapPtr makeCombinedMap(std::vector<ThicknessMapPtr> maps, std::function<double(const double*)> function);

} // namespace patina
