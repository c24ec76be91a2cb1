#include "model_input.h"

#include "base/errors.h"
#include "base/names.h"
#include "base/units.h"
#include "surface/atlas.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/mesh_repair.h"
#include "surface/region_charts.h"
#include "surface/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

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

// What does not fit into UV tiles is told before a long run and not after it. UVs that stick out of their tile by a texel
// or two, as packers leave them, are moved to its border; NAME.obj has them so. With several tiles that is half a texel of
// a map of 4096 inside: what lies on the border itself other programs read from the next tile.
void fitUvs(Mesh& mesh, const std::string& name, Console& console) {
    constexpr float tolerance = 0.005f;
    const auto sticksOut = [&](const Imath::V2f& uv, const Imath::V2f& low) {
        return !(uv.x >= low.x - tolerance && uv.x <= low.x + 1.f + tolerance && uv.y >= low.y - tolerance &&
                 uv.y <= low.y + 1.f + tolerance);
    };
    std::vector<Imath::V2f> tiles; // low corners, by face
    std::size_t corner = 0;
    bool several = false;
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        Imath::V2d middle(0.0);
        for (int i = 0; i < mesh.faceSizes[face]; ++i)
            middle += Imath::V2d(mesh.uvs[mesh.faceUvs[corner + i]]) / double(mesh.faceSizes[face]);
        Imath::V2f tile(static_cast<float>(std::floor(middle.x)), static_cast<float>(std::floor(middle.y)));
        bool home = true; // in the first tile, on whose border a face without an area may lie
        for (int i = 0; i < mesh.faceSizes[face]; ++i)
            home = home && !sticksOut(mesh.uvs[mesh.faceUvs[corner + i]], Imath::V2f(0.f));
        if (home)
            tile = Imath::V2f(0.f);
        const bool numbered = tile.x >= 0.f && tile.x <= 9.f && tile.y >= 0.f && tile.y <= 899.f; // false for NaN
        for (int i = 0; i < mesh.faceSizes[face]; ++i, ++corner) {
            const Imath::V2f uv = mesh.uvs[mesh.faceUvs[corner]];
            if (!numbered || sticksOut(uv, tile))
                throw ModelError(
                    name,
                    fmt::format("face {}: its UV ({:.5g}, {:.5g}) lies outside the {}", face + 1, uv.x, uv.y,
                                numbered && tile != Imath::V2f(0.f)
                                    ? fmt::format("tile {} of the others", 1001 + int(tile.x) + 10 * int(tile.y))
                                    : std::string("unit square")),
                    "move the UVs into one tile (or each face into one with a number), or replace them with --atlas");
        }
        several = several || tile != Imath::V2f(0.f);
        tiles.push_back(tile);
    }
    const float inset = several ? 1.f / 8192.f : 0.f;
    float furthest = 0.f;
    const auto clamped = [&](const Imath::V2f& uv, const Imath::V2f& low) {
        const Imath::V2f inside(std::clamp(uv.x, low.x + inset, low.x + 1.f - inset),
                                std::clamp(uv.y, low.y + inset, low.y + 1.f - inset));
        furthest = std::max({furthest, std::abs(uv.x - inside.x), std::abs(uv.y - inside.y)});
        return inside;
    };
    if (several) {
        std::map<std::pair<int, std::pair<float, float>>, int> moved; // a UV may be used from two tiles
        corner = 0;
        for (std::size_t face = 0; face < mesh.faceCount(); ++face)
            for (int i = 0; i < mesh.faceSizes[face]; ++i, ++corner) {
                const int index = mesh.faceUvs[corner];
                const Imath::V2f inside = clamped(mesh.uvs[index], tiles[face]);
                if (inside == mesh.uvs[index])
                    continue;
                const auto [found, isNew] = moved.emplace(
                    std::make_pair(index, std::make_pair(inside.x, inside.y)), static_cast<int>(mesh.uvs.size()));
                if (isNew)
                    mesh.uvs.push_back(inside);
                mesh.faceUvs[corner] = found->second;
            }
    } else {
        for (Imath::V2f& uv : mesh.uvs)
            uv = clamped(uv, Imath::V2f(0.f));
    }
    if (furthest > std::max(1e-4f, 2.f * inset))
        console.warning(fmt::format("UVs reach {:.2g} beyond {} and were moved to its border", furthest,
                                    several ? "their tile" : "the unit square"));
}

// Many triangles and nothing else.
bool isScan(const Mesh& mesh) {
    return mesh.faceSizes.size() >= 500 &&
           std::all_of(mesh.faceSizes.begin(), mesh.faceSizes.end(), [](int size) { return size == 3; });
}

// The model becomes its piece in the box.
void cutRegion(Model& model, const Imath::Box3d& box, const Options& options, const VolumeScale* scale,
               const RegionRequest& request, Console& console) {
    model.scale = scale ? *scale : regionScale(box, options);
    if (request.existing && RegionModel::hashOf(model.mesh) == request.existing->pieceHash) {
        model.region = request.existing;
        model.surface = RegionModel::shownFrom(model.mesh, *model.region);
        model.longestSide = longest(model.surface.bounds());
        return;
    }
    const double reach = request.reachVoxels ? request.reachVoxels(model.scale) : 4.0;
    const Region region = request.existing ? *request.existing : makeRegion(box, modelVoxelSize(box, options), reach);
    RegionModel::Options cut;
    cut.limit.scheme = schemeNamed(options.scheme);
    cut.limit.level = options.subdivide;
    cut.up = upVector(options.up);
    cut.resolution = options.resolution;
    if (options.atlas)
        makeFaceAtlas(model.mesh, options.resolution);
    model.whole = std::make_shared<RegionModel>(std::move(model.mesh), region, cut);
    model.region = model.whole->region();
    model.mesh = model.whole->control();
    model.surface = model.whole->shown();
    model.longestSide = model.whole->longestSide();
    if (!options.context.empty())
        model.context = std::make_shared<ContextFields>(options.context, region.surfaceBox(), options.metresPerUnit());
    if (!model.whole->whole().note.empty())
        console.warning(model.whole->whole().note);
    const double um = model.scale.metresPerUnit * region.magnification * 1e6;
    const Imath::V3d size = box.size();
    console.notice(fmt::format("{}: region of {} × {} × {} out of {}, {} triangles; voxels of {}, {:.0f} more around it",
                               model.name, readableLength(size.x * um), readableLength(size.y * um),
                               readableLength(size.z * um), readableLength(model.longestSide * um),
                               model.surface.triangles.size(), readableLength(region.voxelSize * um),
                               region.marginVoxels()));
}

// What is new of the findings.
void tellFindings(const MeshReport& findings, std::size_t firstWarning, std::size_t firstNotice, Console& console) {
    for (std::size_t i = firstWarning; i < findings.warnings.size(); ++i)
        console.warning(findings.warnings[i]);
    for (std::size_t i = firstNotice; i < findings.notices.size(); ++i)
        console.notice(findings.notices[i]);
}

std::string describeShells(const Model& model) {
    std::size_t sheets = 0;
    for (const MeshReport::Shell& shell : model.findings.shells)
        sheets += shell.kind == MeshReport::ShellKind::sheet;
    if (model.surface.closed)
        return "closed";
    return sheets == model.findings.shells.size() ? "open, gets a back"
                                                  : fmt::format("{} of {} shells open, get a back", sheets,
                                                                model.findings.shells.size());
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

Model loadModel(const std::string& name, const Options& options, const VolumeScale* scale, Console& console,
                const RegionRequest& request) {
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
    const std::optional<Imath::Box3d> box = request.existing ? request.existing->box : regionBoxOf(options);
    // The piece of a region is open at the box's sides, and stays so.
    if (!request.existing || RegionModel::hashOf(model.mesh) != request.existing->pieceHash) {
        model.findings = repairMesh(model.mesh, repairModeNamed(options.repair));
        tellFindings(model.findings, 0, 0, console);
    }
    if (box) {
        cutRegion(model, *box, options, scale, request, console);
        return model;
    }
    if (!options.context.empty())
        throw Error(ExitCode::commandLine, "--context", "is for close-ups: there is no --region",
                    "add --region or --region-at");
    if (options.atlas || !model.mesh.hasUvs()) {
        // A tile of a face each would leave a scan's triangles a few texels, and seams along every edge.
        const bool charts = isScan(model.mesh);
        if (!options.atlas)
            console.notice(charts ? "the model has no UVs: its triangles get charts by the way they face"
                                  : "the model has no UVs: each face gets a tile of its own");
        if (charts)
            makeProjectedCharts(model.mesh, {0.0, 1.0, 0.0}, options.resolution);
        else
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
    if (!scale) {
        const std::size_t warned = model.findings.warnings.size(), noticed = model.findings.notices.size();
        checkWalls(model.surface, model.scale.voxelSize, model.longestSide, model.findings);
        tellFindings(model.findings, warned, noticed, console);
    }
    const double um = model.scale.metresPerUnit * 1e6;
    const Imath::V3f size = model.surface.bounds().size();
    console.notice(fmt::format("{}: {} × {} × {}, {} triangles, {}; voxels of {}", model.name,
                               readableLength(size.x * um), readableLength(size.y * um), readableLength(size.z * um),
                               model.surface.triangles.size(), describeShells(model),
                               readableLength(model.scale.voxelSize * um)));
    return model;
}

} // namespace patina::tool
