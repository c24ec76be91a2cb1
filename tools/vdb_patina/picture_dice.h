#pragma once
// How a picture's surface is diced.

#include "options.h"
#include "view_input.h"

#include "render/dice.h"

namespace patina::tool {

/// Dicing of a model under layers for a picture. \param voxel  the volume's voxel size: what the stack is read at
/// vertices for must not be wider than one and a half of them
DiceOptions dicingOf(const View& view, const Options& options, double voxel);

} // namespace patina::tool
