#include "optics/material.h"

#include <cmath>

namespace patina {

float ggxAlpha(float paperRoughness) {
    return std::sqrt(2.f / (1.f / paperRoughness + 2.f));
}

} // namespace patina
