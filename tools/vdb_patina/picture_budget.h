#pragma once
// What the picture at the end of a run will take, before the run starts.

#include "model_input.h"
#include "options.h"

namespace patina::tool {

/// Of a picture itself: light takes 12 bytes a pixel, features 44, their halves as much again.
inline constexpr double bytesPerPixel = 160.0;

/// Memory of the picture that `options` ask for of a model under layers: the surface cut into triangles of a pixel where
/// the camera sees it, their trees and stacks, and the picture. Counted from what the bare model's triangles that face the
/// camera cover in it; 0 without a picture.
/// \throws Error (command line) where --camera or --closeup cannot be read
double pictureBytes(const Options& options, const Model& model);

} // namespace patina::tool
