#pragma once
// Points as they are written on a command line and in files of points.

#include <Imath/ImathVec.h>

#include <optional>
#include <string>

namespace patina::tool {

/// "x,y,z", "x;y;z" or "x y z"; empty for anything else.
std::optional<Imath::V3d> pointInText(std::string text);

} // namespace patina::tool
