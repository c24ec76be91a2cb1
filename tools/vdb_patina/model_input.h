#pragma once
// From the command line's MODEL to the surface everything else works on.

#include "console.h"
#include "options.h"
#include "region_input.h"
#include "surface/mesh.h"
#include "surface/mesh_report.h"
#include "volume/layer_volume.h"
#include "volume/region_context.h"
#include "volume/region_model.h"

#include <Imath/ImathVec.h>

#include <memory>
#include <optional>
#include <string>

namespace patina::tool {

struct Model {
    Mesh mesh;           ///< the control mesh, with the UVs that the maps use
    SurfaceMesh surface; ///< its limit surface
    VolumeScale scale;
    double longestSide = 0.0; ///< of the whole model, scene units
    std::string name;
    MeshReport findings; ///< what was found out about the mesh, and repaired

    // Of a close-up: mesh and surface are the piece in its box. The surface is in the volume's coordinates.
    std::optional<Region> region;
    std::shared_ptr<const RegionModel> whole;     ///< null where the piece alone was given (NAME.obj)
    std::shared_ptr<const ContextFields> context; ///< of --context

    Imath::V3d toModel(const Imath::V3d& local) const { return region ? region->toModel(local) : local; }
    Imath::V3d toLocal(const Imath::V3d& inModel) const { return region ? region->toLocal(inModel) : inModel; }
    /// The volume's units per unit of the model.
    double magnification() const { return region ? region->magnification : 1.0; }
};

/// Reads a file, or makes one of the shapes where `name` is one and no such file exists. Makes an atlas where the model
/// has no UVs (or --atlas asks for one), and the limit surface at the volume's resolution. \param scale  of an existing
/// volume; null: from the options \param request  what is known of the region, if it is one
Model loadModel(const std::string& name, const Options& options, const VolumeScale* scale, Console& console,
                const RegionRequest& request = {});

Imath::V3d upVector(UpAxis up);

/// The control mesh that `run` writes beside a volume: the model of commands that are given none.
/// \throws Error (command line) where there is none
std::string modelBeside(const std::string& volumeFile);

/// A shape of `make`, turned so that y is up, as OBJ files are.
Mesh makeUprightShape(const std::string& name);

} // namespace patina::tool
