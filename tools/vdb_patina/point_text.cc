#include "point_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace patina::tool {

std::optional<Imath::V3d> pointInText(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream in(text);
    Imath::V3d p;
    std::string more;
    if (!(in >> p.x >> p.y >> p.z) || in >> more || !std::isfinite(p.x + p.y + p.z))
        return std::nullopt;
    return p;
}

} // namespace patina::tool
