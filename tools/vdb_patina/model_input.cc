#include "model_input.h"

#include "base/errors.h"
#include "base/names.h"
#include "base/units.h"
#include "surface/atlas.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace patina::tool {

namespace {

constexpr double fewestVoxels = 8.0; // as --voxels

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

std::string shapeHint(const std::string& name, const std::vector<std::string>& shapes) {
    const std::string hint = didYouMean(name, shapes);
    return hint.empty() ? "shapes are " + fmt::format("{}", fmt::join(shapes, ", ")) : hint;
}

// The maps are one tile: what does not fit is told before a long run and not after it. UVs that stick out by a texel or
// two, as packers leave them, are moved to the border; NAME.obj has them so.
void fitUvs(Mesh& mesh, const std::string& name, Console& console) {
    constexpr float tolerance = 0.005f;
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.faceCount(); ++face)
        for (int i = 0; i < mesh.faceSizes[face]; ++i, ++corner) {
            const Imath::V2f uv = mesh.uvs[mesh.faceUvs[corner]];
            if (!(uv.x >= -tolerance && uv.x <= 1.f + tolerance && uv.y >= -tolerance && uv.y <= 1.f + tolerance))
                throw ModelError(
                    name,
                    fmt::format("face {}: its UV ({:.5g}, {:.5g}) lies outside the unit square", face + 1, uv.x, uv.y),
                    "move the UVs into one tile, or replace them with --atlas");
        }
    float furthest = 0.f;
    for (Imath::V2f& uv : mesh.uvs) {
        const Imath::V2f inside(std::clamp(uv.x, 0.f, 1.f), std::clamp(uv.y, 0.f, 1.f));
        furthest = std::max({furthest, std::abs(uv.x - inside.x), std::abs(uv.y - inside.y)});
        uv = inside;
    }
    if (furthest > 1e-4f)
        console.warning(fmt::format("UVs reach {:.2g} beyond the unit square and were moved to its border", furthest));
}

} // namespace

Imath::V3d upVector(UpAxis up) {
    return up == UpAxis::y ? Imath::V3d(0, 1, 0) : Imath::V3d(0, 0, 1);
}

std::string modelBeside(const std::string& volumeFile) {
    const auto file = std::filesystem::path(volumeFile).replace_extension(".obj");
    std::error_code ignored;
    if (std::filesystem::exists(volumeFile, ignored) && !std::filesystem::exists(file, ignored))
        throw Error(ExitCode::commandLine, volumeFile,
                    fmt::format("there is no '{}' beside it", file.filename().string()),
                    "give the model that it was made from, behind the volume");
    return file.string();
}

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
    else if (std::filesystem::exists(name, ignored) || std::filesystem::path(name).has_extension())
        model.mesh = readMesh(name);
    else
        throw ModelError(name, "is neither a file nor a shape that the program can make", shapeHint(name, shapes));
    model.name = model.mesh.name;
    if (options.atlas || !model.mesh.hasUvs()) {
        if (!options.atlas)
            console.notice("the model has no UVs: each face gets a tile of its own");
        makeFaceAtlas(model.mesh, options.resolution);
    }

    fitUvs(model.mesh, name, console);

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
        if (model.longestSide < fewestVoxels * model.scale.voxelSize)
            throw Error(ExitCode::commandLine, "--voxel-size",
                        fmt::format("the model's longest side of {:.4g} scene units would be {:.2g} voxels",
                                    model.longestSide, model.longestSide / model.scale.voxelSize),
                        fmt::format("give {:.2g} or less, or use --voxels", model.longestSide / 64.0));
    }
    limit.level = options.subdivide;
    limit.targetEdge = 1.5 * model.scale.voxelSize;
    model.surface = makeLimitSurface(model.mesh, limit);
    if (!model.surface.note.empty())
        console.warning(model.surface.note);
    const double um = model.scale.metresPerUnit * 1e6;
    const Imath::V3f size = model.surface.bounds().size();
    console.notice(fmt::format("{}: {} × {} × {}, {} triangles, {}; voxels of {}", model.name,
                               readableLength(size.x * um), readableLength(size.y * um), readableLength(size.z * um),
                               model.surface.triangles.size(), model.surface.closed ? "closed" : "open, gets a back",
                               readableLength(model.scale.voxelSize * um)));
    return model;
}

} // namespace patina::tool
