// vdb-patina info FILE

#include "commands.h"
#include "console.h"

#include "base/units.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace patina::tool {

namespace {

struct Arguments {
    std::string file;
    bool json = false;
};

void tell(const Arguments& arguments, Console& console) {
    const LayerVolume volume = readVolume(arguments.file);
    const VolumeScale& scale = volume.scale();
    const auto& from = volume.provenance;
    const double voxelUm = scale.voxelSize * scale.metresPerUnit * 1e6;
    if (arguments.json) {
        nlohmann::ordered_json json;
        json["file"] = arguments.file;
        json["model"] = from.model;
        json["model_hash"] = from.modelHash;
        json["script_name"] = from.scriptName;
        json["script"] = from.script;
        json["seed"] = from.seed;
        json["program"] = from.program;
        json["voxel_size_units"] = scale.voxelSize;
        json["metres_per_unit"] = scale.metresPerUnit;
        json["exaggeration"] = scale.exaggeration;
        json["palette"] = volume.palette();
        json["layers"] = volume.layers();
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
    std::string text = fmt::format("{}\n  model '{}', script '{}', seed {}, vdb-patina {}\n", arguments.file, from.model,
                                   from.scriptName, from.seed, from.program);
    text += fmt::format("  voxels of {} ({:.6g} scene units of {:g} m), thickness drawn {:g} times life size\n",
                        readableLength(voxelUm), scale.voxelSize, scale.metresPerUnit, scale.exaggeration);
    text += fmt::format("  {} million voxels in the band, {} in memory\n", double(volume.activeVoxels()) * 1e-6,
                        readableBytes(double(volume.memoryBytes())));
    text += "  materials:";
    for (std::size_t id = 0; id < volume.palette().size(); ++id)
        text += fmt::format(" {}={}", id, volume.palette()[id]);
    text += "\n  grids:\n";
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
    command->add_flag("--json", arguments->json, "As JSON, with the script's text");
    addGeneralOptions(*command, options);
    command->callback(
        [&action, arguments] { action = [arguments](Console& console) { tell(*arguments, console); }; });
}

} // namespace patina::tool
