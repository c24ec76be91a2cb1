#pragma once
// From the command line's MODEL to the surface everything else works on.

#include "console.h"
#include "options.h"
#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <string>

namespace patina::tool {

struct Model {
    Mesh mesh;           ///< the control mesh, with the UVs that the maps use
    SurfaceMesh surface; ///< its limit surface
    VolumeScale scale;
    double longestSide = 0.0; ///< scene units
    std::string name;
};

/// Reads a file, or makes one of the shapes where `name` is one and no such file exists. Makes an atlas where the model
/// has no UVs (or --atlas asks for one), and the limit surface at the volume's resolution. \param scale  of an existing
/// volume; null: from the options
Model loadModel(const std::string& name, const Options& options, const VolumeScale* scale, Console& console);

Imath::V3d upVector(UpAxis up);

/// The control mesh that `run` writes beside a volume: the model of commands that are given none.
/// \throws Error (command line) where there is none
std::string modelBeside(const std::string& volumeFile);

/// A shape of `make`, turned so that y is up, as OBJ files are.
Mesh makeUprightShape(const std::string& name);

} // namespace patina::tool
