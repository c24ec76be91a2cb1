#include "outputs.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "export/map_files.h"
#include "export/materialx_file.h"
#include "export/micro_mesh.h"
#include "export/usd_file.h"
#include "surface/mesh_file.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina::tool {

StackOptics opticsOf(const LayerVolume& volume, const MaterialLibrary& materials, const Options& options) {
    std::vector<const Material*> stack{&materials.at(volume.metal())};
    for (const std::string& layer : volume.layers())
        stack.push_back(&materials.at(layer));
    StackFeatures features;
    features.thinFilm = options.thinFilm;
    features.colourSpace = options.colourSpace == "acescg" ? ColourSpace::acescg : ColourSpace::rec709;
    return StackOptics(stack, options.optics == "paper" ? OpticsModel::paper : OpticsModel::energyConserving, features);
}

VolumeFileOptions volumeFileOptions(const Options& options) {
    return {options.halfFields, options.up == UpAxis::z ? "z" : "y"};
}

OutputFolder outputFolder(const Options& options, const std::string& name) {
    return OutputFolder(options.output.empty() ? name : options.output);
}

std::filesystem::path reportFile(const Options& options, const std::filesystem::path& folder, const std::string& name) {
    if (options.report.empty())
        return folder / name;
    // Not only found out when all is done.
    if (std::filesystem::is_directory(options.report))
        throw RunError(options.report, "is a folder", "--report takes the name of a file");
    const AtomicFile writable(options.report);
    return options.report;
}

// What the surface was made by (surface/limit_surface.h), as USD calls it.
static const char* schemeOf(const Model& model, const Options& options) {
    if (model.region || !model.surface.note.empty() || options.scheme == "none")
        return "none";
    if (options.scheme == "loop")
        return "loop";
    const bool polygons =
        std::any_of(model.mesh.faceSizes.begin(), model.mesh.faceSizes.end(), [](int size) { return size > 3; });
    return polygons || options.scheme == "catmull-clark" ? "catmullClark" : "none";
}

// The diced surface in the model's coordinates as a mesh.
static Mesh dicedMesh(const Model& model) {
    Mesh mesh;
    for (const Imath::V3f& p : model.surface.positions)
        mesh.positions.emplace_back(model.toModel(Imath::V3d(p)));
    mesh.uvs = model.surface.uvs;
    mesh.faceSizes.assign(model.surface.triangles.size(), 3);
    for (std::size_t t = 0; t < model.surface.triangles.size(); ++t)
        for (int corner = 0; corner < 3; ++corner) {
            mesh.faceVertices.push_back(model.surface.triangles[t][corner]);
            mesh.faceUvs.push_back(model.surface.triangleUvs[t][corner]);
        }
    return mesh;
}

static void writeScene(const LayerVolume& volume, const Model& model, const BakeSummary& summary,
                       const Options& options, const std::string& name, const std::filesystem::path& volumeFile,
                       const std::filesystem::path& folder, std::vector<std::string>& outputs, Console& console) {
    const ProgressStage stage(console, "write scene");
    UsdScene scene;
    scene.name = name;
    scene.scheme = schemeOf(model, options);
    // The normals of a close-up are those of its dice.
    const Mesh diced = model.region ? dicedMesh(model) : Mesh();
    scene.mesh = model.region ? &diced : &model.mesh;
    if (std::string(scene.scheme) == "none" && model.surface.normals.size() == scene.mesh->positions.size())
        scene.normals = &model.surface.normals;
    scene.metresPerUnit = volume.scale().metresPerUnit * model.magnification();
    scene.zUp = options.up == UpAxis::z;
    scene.maps.baked = true;
    scene.maps.colourSpace = options.colourSpace == "acescg" ? ColourSpace::acescg : ColourSpace::rec709;
    scene.maps.maxDisplacement = summary.maxDisplacement;
    scene.maps.severalTiles = summary.tiles.size() > 1;
    // Paths hold where the folder is moved together with the volume.
    std::error_code failure;
    const auto relative = std::filesystem::proximate(volumeFile, folder, failure);
    scene.volumeFile = (failure ? volumeFile : relative).generic_string();
    scene.volumeUnitsPerUnit = model.magnification();
    for (const GridSummary& grid : summarizeGrids(volume)) {
        const bool levelSet = grid.gridClass == "level set";
        if (grid.name != "surface" && (grid.type == "float" || grid.type == "int32"))
            scene.fields.push_back({grid.name, grid.type == "int32", levelSet});
    }
    scene.fields.push_back({"surface", false, true}); // the last interface once more, under its common name
    scene.documentation =
        fmt::format("vdb-patina {}: {} on {}", PATINA_VERSION, volume.provenance.scriptName, volume.provenance.model);
    writeUsd(scene, folder / (name + ".usda"));
    outputs.push_back(name + ".usda");
    writeMaterialX(name, scene.maps, folder / (name + ".mtlx"));
    outputs.push_back(name + ".mtlx");
}

BakeSummary writeMaps(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                      const std::filesystem::path& folder, std::vector<std::string>& outputs, Console& console,
                      const std::filesystem::path& volumeFile) {
    BakeOptions bakeOptions;
    bakeOptions.resolution = options.resolution;
    bakeOptions.keepExaggeration = options.keepExaggeration;
    bakeOptions.materialId = options.materialId;
    bakeOptions.foldMask = options.foldMask;
    bakeOptions.vectorDisplacement = options.vectorDisplacement;
    bakeOptions.vectorSpace = vectorSpaceNamed(options.vectorSpace);
    bakeOptions.fields = options.fields;
    // Displacement is in the model's units, which a volume of very small voxels is not.
    bakeOptions.displacementUnits = 1.0 / model.magnification();
    MapFiles files(folder, {{"patina_program", "vdb-patina " PATINA_VERSION},
                            {"patina_script", volume.provenance.scriptName},
                            {"patina_model", volume.provenance.model}});
    BakeSummary summary;
    {
        const ProgressStage stage(console, "bake maps");
        summary = bakeInto(files, volume, model.surface, optics, bakeOptions, console);
    }
    // One texel in a thousand is what creases give that no renderer shows.
    if (summary.foldFraction > 1e-3 && !options.vectorDisplacement)
        console.warning(fmt::format("on {:.2g} % of the surface the layers hang over: a height map draws walls there; "
                                    "--vector-displacement follows them, --fold-mask shows where",
                                    summary.foldFraction * 100.0));
    if (summary.overlapFraction > 0.0)
        console.warning(fmt::format("{:.2g} % of the charts lie on each other in the UVs, as do faces {} and {}: the "
                                    "face with the smaller number is baked there",
                                    summary.overlapFraction * 100.0, summary.overlappingFaces.first + 1,
                                    summary.overlappingFaces.second + 1));
    {
        const ProgressStage stage(console, "write maps");
        if (options.tx)
            files.makeTextures(console);
        for (std::string& file : files.commit())
            outputs.push_back(std::move(file));
    }
    const std::string name = volumeFile.empty() ? volume.provenance.scriptName : volumeFile.stem().string();
    writeScene(volume, model, summary, options, name, volumeFile.empty() ? folder / (name + ".vdb") : volumeFile,
               folder, outputs, console);
    return summary;
}

void writeMicroMesh(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                    const std::string& name, const std::filesystem::path& folder, std::vector<std::string>& outputs,
                    Console& console) {
    if (!options.microMesh)
        return;
    const ProgressStage stage(console, "micro mesh");
    SurfaceMesh mesh = makeMicroMesh(volume, model.surface, optics, options.keepExaggeration, console);
    for (Imath::V3f& p : mesh.positions)
        p = Imath::V3f(model.toModel(Imath::V3d(p)));
    writePly(mesh, folder / (name + "_micro.ply"));
    outputs.push_back(name + "_micro.ply");
}

void writeMeshes(const Model& model, const Options& options, const std::string& name,
                 const std::filesystem::path& folder, std::vector<std::string>& outputs, Console& console) {
    const ProgressStage stage(console, "write meshes");
    // What is not subdivided is displaced along the normals that the maps were baked along.
    const bool plain = !model.region && model.surface.normals.size() == model.mesh.positions.size() &&
                       std::string(schemeOf(model, options)) == "none";
    writeObj(model.mesh, folder / (name + ".obj"), plain ? &model.surface.normals : nullptr);
    if (model.region) {
        SurfaceMesh placed = model.surface;
        for (Imath::V3f& p : placed.positions)
            p = Imath::V3f(model.toModel(Imath::V3d(p)));
        writePly(placed, folder / (name + "_limit.ply"));
    } else {
        writePly(model.surface, folder / (name + "_limit.ply"));
    }
    outputs.push_back(name + ".obj");
    outputs.push_back(name + "_limit.ply");
}

} // namespace patina::tool
