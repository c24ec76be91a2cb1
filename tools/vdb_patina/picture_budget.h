#pragma once
// What the picture at the end of a run will take, before the run starts.

#include "model_input.h"
#include "options.h"

namespace patina::tool {

/// Of a picture itself: its light and that as it is shown take 12 bytes a pixel each, the PNG 3; an EXR's features 44,
/// and as much again with the light while they are written.
constexpr double bytesPerPixel(bool exr) {
    return exr ? 160.0 : 27.0;
}

/// Memory of the picture that `options` ask for of a model under so many layers: the surface cut into triangles of a
/// pixel where the camera sees it (dicedTriangles(), of the bare model), their trees and stacks, and the picture; 0
/// without a picture. \throws Error (command line) where --camera or --closeup cannot be read
double pictureBytes(const Options& options, const Model& model, int layers);

} // namespace patina::tool
