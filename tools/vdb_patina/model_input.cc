#include "model_input.h"

#include "base/errors.h"
#include "base/units.h"
#include "surface/atlas.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace patina::tool {

namespace {

SubdivisionScheme schemeNamed(const std::string& name) {
    if (name == "none")
        return SubdivisionScheme::none;
    if (name == "catmull-clark")
        return SubdivisionScheme::catmullClark;
    if (name == "loop")
        return SubdivisionScheme::loop;
    return SubdivisionScheme::automatic;
}

double longest(const Imath::Box3f& box) {
    const Imath::V3f size = box.size();
    return std::max({size.x, size.y, size.z});
}

} // namespace

Imath::V3d upVector(UpAxis up) { return up == UpAxis::y ? Imath::V3d(0, 1, 0) : Imath::V3d(0, 0, 1); }

Mesh makeUprightShape(const std::string& name) {
    Mesh mesh = makeShape(name);
    for (Imath::V3f& p : mesh.positions)
        p = {p.x, p.z, -p.y};
    return mesh;
}

Model loadModel(const std::string& name, const Options& options, const VolumeScale* scale, Console& console) {
    const ProgressStage stage(console, "model " + name);
    Model model;
    const auto shapes = shapeNames();
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored) && std::find(shapes.begin(), shapes.end(), name) != shapes.end())
        model.mesh = makeUprightShape(name);
    else
        model.mesh = readMesh(name);
    model.name = model.mesh.name;
    if (options.atlas || !model.mesh.hasUvs()) {
        if (!options.atlas)
            console.notice("the model has no UVs: each face gets a tile of its own");
        makeFaceAtlas(model.mesh, options.resolution);
    }

    LimitSurfaceOptions limit;
    limit.scheme = schemeNamed(options.scheme);
    limit.level = 1;
    // A coarse limit surface tells the size: a cage is larger than what it stands for.
    model.longestSide = longest(makeLimitSurface(model.mesh, limit).bounds());
    if (scale) {
        model.scale = *scale;
    } else {
        model.scale.metresPerUnit = options.metresPerUnit();
        model.scale.exaggeration = options.exaggeration;
        model.scale.voxelSize = options.voxelSize > 0.0 ? options.voxelSize : model.longestSide / options.voxels;
    }
    limit.level = options.subdivide;
    limit.targetEdge = 1.5 * model.scale.voxelSize;
    model.surface = makeLimitSurface(model.mesh, limit);
    if (!model.surface.note.empty())
        console.warning(model.surface.note);
    const double um = model.scale.metresPerUnit * 1e6;
    const Imath::V3f size = model.surface.bounds().size();
    console.notice(fmt::format("{}: {} × {} × {}, {} triangles, {}; voxels of {}", model.name, readableLength(size.x * um),
                               readableLength(size.y * um), readableLength(size.z * um), model.surface.triangles.size(),
                               model.surface.closed ? "closed" : "open, gets a back",
                               readableLength(model.scale.voxelSize * um)));
    return model;
}

} // namespace patina::tool
