#pragma once
// Models to try things on: vdb-patina make plate|strip|sphere|groove|tower|statuette.

#include "surface/mesh.h"

#include <string>
#include <vector>

namespace patina {

/// The shapes' names, in the order of the manual.
std::vector<std::string> shapeNames();

/// A quad mesh with UVs, in metres, z up, standing on z = 0 (plate and strip: open sheets facing +z; all others
/// closed). Tower and statuette are subdivision cages of several closed parts that run into each other: a voxeliser
/// takes their union. The statuette looks towards -y. \throws Error (exit 2) for an unknown name, with the nearest one.
Mesh makeShape(const std::string& name);

} // namespace patina
