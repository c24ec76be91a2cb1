// vdb-patina info FILE [MODEL]

#include "commands.h"
#include "console.h"
#include "model_input.h"

#include "base/errors.h"
#include "base/units.h"
#include "script/interpreter.h"
#include "volume/layer_statistics.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>

namespace patina::tool {

namespace {

struct Arguments {
    std::string file;
    std::string model;
    bool json = false;
};

// Thickness is read along the model's normals; without the model a volume tells all but that.
std::optional<StackStatistics> statisticsOf(const LayerVolume& volume, const Arguments& arguments,
                                            const Options& options, Console& console) {
    std::string file = arguments.model;
    if (file.empty()) {
        const auto beside = std::filesystem::path(arguments.file).replace_extension(".obj");
        if (!std::filesystem::exists(beside))
            return std::nullopt;
        file = beside.string();
    }
    const Model model = loadModel(file, options, &volume.scale(), console, RegionRequest::of(volume, arguments.file));
    const bool isPiece = model.region && !model.whole;
    if (!isPiece && surfaceHash(model.surface) != volume.provenance.modelHash) {
        if (!arguments.model.empty())
            throw ModelError(file, fmt::format("is not the model that '{}' was made from", arguments.file),
                             "give the same model, with the same --subdivide, --scheme and --atlas");
        return std::nullopt;
    }
    return measureStack(volume, model.surface);
}

void tell(const Arguments& arguments, const Options& options, Console& console) {
    const LayerVolume volume = readVolume(arguments.file);
    const auto stack = statisticsOf(volume, arguments, options, console);
    const VolumeScale& scale = volume.scale();
    const auto& from = volume.provenance;
    const double voxelUm = scale.voxelSize * scale.metresPerUnit * 1e6;
    const auto region = RegionRequest::of(volume, arguments.file).existing;
    const double magnification = region ? region->magnification : 1.0;
    if (arguments.json) {
        nlohmann::ordered_json json;
        json["file"] = arguments.file;
        json["model"] = from.model;
        json["model_hash"] = from.modelHash;
        json["script_name"] = from.scriptName;
        json["script"] = from.script;
        json["seed"] = from.seed;
        json["program"] = from.program;
        json["voxel_size_units"] = scale.voxelSize / magnification;
        json["metres_per_unit"] = scale.metresPerUnit * magnification;
        json["exaggeration"] = scale.exaggeration;
        if (!from.region.empty())
            json["region"] = from.region;
        json["palette"] = volume.palette();
        json["layers"] = volume.layers();
        if (stack)
            for (const LayerStatistics& layer : stack->layers)
                json["thickness"].push_back({{"material", layer.material},
                                             {"mean_um", layer.meanUm},
                                             {"max_um", layer.maxUm},
                                             {"coverage", layer.coverage},
                                             {"rq_um", layer.roughnessUm},
                                             {"volume_m3", layer.volumeM3}});
        for (const GridSummary& grid : summarizeGrids(volume))
            json["grids"].push_back({{"name", grid.name},
                                     {"type", grid.type},
                                     {"class", grid.gridClass},
                                     {"active_voxels", grid.activeVoxels},
                                     {"bytes", grid.bytes}});
        json["content_hash"] = contentHash(volume);
        console.result(json.dump(2));
        return;
    }
    std::string text = fmt::format("{}\n  model '{}', script '{}', seed {}, vdb-patina {}\n", arguments.file,
                                   from.model, from.scriptName, from.seed, from.program);
    text += fmt::format("  voxels of {} ({:.6g} scene units of {:g} m), thickness drawn {:g} times life size\n",
                        readableLength(voxelUm), scale.voxelSize / magnification, scale.metresPerUnit * magnification,
                        scale.exaggeration);
    if (region) {
        const Imath::V3d &low = region->box.min, &high = region->box.max;
        text += fmt::format("  a region: {:.9g},{:.9g},{:.9g} to {:.9g},{:.9g},{:.9g}; {:.0f} voxels around it besides\n",
                            low.x, low.y, low.z, high.x, high.y, high.z, region->marginVoxels());
    }
    if (magnification != 1.0)
        text += fmt::format("  the .vdb's own coordinates are the model's times {:g}\n", magnification);
    text += fmt::format("  {:.3g} million voxels in the band, {} in memory\n", double(volume.activeVoxels()) * 1e-6,
                        readableBytes(double(volume.memoryBytes())));
    text += "  materials:";
    for (std::size_t id = 0; id < volume.palette().size(); ++id)
        text += fmt::format(" {}={}", id, volume.palette()[id]);
    if (stack) {
        text += "\n  layers, top to bottom:\n";
        for (auto layer = stack->layers.rbegin(); layer != stack->layers.rend(); ++layer)
            text += fmt::format(
                "    {:<24} {:>9.3g} µm on average, {:>8.4g} at most, on {:5.1f} % of the surface, {:.3g} mm³\n",
                layer->material, layer->meanUm, layer->maxUm, 100.0 * layer->coverage, layer->volumeM3 * 1e9);
    } else {
        text += "\n  layers' thickness: give the model behind the file\n";
    }
    text += "  grids:\n";
    for (const GridSummary& grid : summarizeGrids(volume))
        text += fmt::format("    {:<36} {:<6} {:<10} {:>12} voxels {:>10}\n", grid.name, grid.type, grid.gridClass,
                            grid.activeVoxels, readableBytes(double(grid.bytes)));
    text += "  content hash " + contentHash(volume);
    console.result(text);
}

} // namespace

void addInfoCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("info", "What a volume holds: grids, layers, memory, provenance");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("FILE", arguments->file, "A .vdb that `run` wrote")->required();
    command->add_option("MODEL", arguments->model,
                        "The model it was made from (default: the .obj that `run` wrote beside it)");
    command->add_flag("--json", arguments->json, "As JSON, with the script's text")->group("Results");
    addGeneralOptions(*command, options);
    addModelOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { tell(*arguments, options, console); };
    });
}

} // namespace patina::tool
