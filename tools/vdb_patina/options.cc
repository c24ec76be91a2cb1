#include "options.h"

#include "base/errors.h"
#include "base/units.h"

#include <fmt/format.h>

namespace patina::tool {

double Options::metresPerUnit() const { return *micrometresPerUnit(unit) * 1e-6; }

std::map<std::string, std::string> Options::settingMap() const {
    std::map<std::string, std::string> map;
    for (const std::string& setting : settings) {
        const std::size_t equals = setting.find('=');
        if (equals == 0 || equals == std::string::npos)
            throw Error(ExitCode::commandLine, "--set", fmt::format("'{}' is not of the form NAME=VALUE", setting));
        if (!map.emplace(setting.substr(0, equals), setting.substr(equals + 1)).second)
            throw Error(ExitCode::commandLine, "--set", fmt::format("'{}' is set twice", setting.substr(0, equals)));
    }
    return map;
}

void addGeneralOptions(CLI::App& app, Options& options) {
    const std::map<std::string, ProgressStyle> styles = {{"auto", ProgressStyle::automatic},
                                                         {"bar", ProgressStyle::bar},
                                                         {"plain", ProgressStyle::plain},
                                                         {"json", ProgressStyle::json},
                                                         {"none", ProgressStyle::none}};
    app.add_option("--threads", options.threads, "Threads to use; the result does not depend on them (default: all)")
        ->check(CLI::Range(1, 1024));
    app.add_option("--progress", options.progress, "auto, bar, plain, json or none; goes to stderr")
        ->transform(CLI::CheckedTransformer(styles, CLI::ignore_case))
        ->type_name("STYLE");
    auto* verbose = app.add_flag("-v,--verbose", options.verbose, "Say more");
    app.add_flag("-q,--quiet", options.quiet, "Say only what went wrong")->excludes(verbose);
}

void addOutputOption(CLI::App& app, Options& options) {
    app.add_option("-o,--output", options.output, "Folder for the results (made if needed)")->type_name("DIR");
}

void addModelOptions(CLI::App& app, Options& options) {
    const std::map<std::string, UpAxis> axes = {{"y", UpAxis::y}, {"z", UpAxis::z}};
    app.add_option("--unit", options.unit, "Unit of the model's coordinates: m, cm, mm or um (default m)")
        ->check(CLI::IsMember({"m", "cm", "mm", "um"}));
    app.add_option("--up", options.up, "The model's up axis: y or z (default y)")
        ->transform(CLI::CheckedTransformer(axes, CLI::ignore_case))
        ->type_name("AXIS");
    app.add_option("--scheme", options.scheme, "Subdivision: automatic, none, catmull-clark or loop")
        ->check(CLI::IsMember({"automatic", "none", "catmull-clark", "loop"}));
    app.add_option("--subdivide", options.subdivide, "Level of subdivision (default: to about a voxel)")
        ->check(CLI::Range(0, 8));
    app.add_flag("--atlas", options.atlas, "Replace the model's UVs by a tile for each face");
}

void addVolumeOptions(CLI::App& app, Options& options) {
    auto* voxels =
        app.add_option("--voxels", options.voxels, "Voxels along the model's longest side (default 256)")->check(CLI::Range(8, 65536));
    app.add_option("--voxel-size", options.voxelSize, "Size of a voxel in scene units, instead of --voxels")
        ->check(CLI::PositiveNumber)
        ->excludes(voxels);
    app.add_option("--exaggeration", options.exaggeration, "Draw thickness so many times life size (default 1)")
        ->check(CLI::PositiveNumber);
    app.add_option("--seed", options.seed, "Seed of all randomness (default: the script's, or 0)");
}

void addMapOptions(CLI::App& app, Options& options) {
    app.add_option("--resolution", options.resolution, "Texels along a side of the maps (default 1024)")->check(CLI::Range(16, 32768));
    app.add_flag("--keep-exaggeration", options.keepExaggeration, "Displacement as drawn in the volume, not real");
    app.add_flag("--material-id", options.materialId, "Also bake material_id.exr");
    app.add_option("--optics", options.optics, "conserving (default) or paper (its section 4.3 to the letter)")
        ->check(CLI::IsMember({"conserving", "paper"}));
}

void addPictureOptions(CLI::App& app, Options& options) {
    app.add_option("--picture", options.pictureSize, "Pixels along the longer side of the picture; 0: none (default 640)")
        ->check(CLI::Range(0, 16384));
    app.add_option("--samples", options.samples, "Paths per pixel (default 32)")->check(CLI::Range(1, 65536));
    app.add_option("--azimuth", options.azimuth, "Where the camera stands, degrees around the model from its front")
        ->check(CLI::Range(-360.0, 360.0));
    app.add_option("--elevation", options.elevation, "… and above the horizon, degrees")->check(CLI::Range(-89.0, 89.0));
}

void addRunOptions(CLI::App& app, Options& options) {
    app.add_option("--set", options.settings, "Value of a script's parameter")->type_name("NAME=VALUE")->allow_extra_args(false);
    app.add_option("--budget", options.budgetGiB, "Memory the run may take (default: four fifths of the machine's)")
        ->check(CLI::PositiveNumber)
        ->type_name("GIB");
    app.add_flag("--dry-run", options.dryRun, "Check everything and print the budget, run nothing");
    app.add_flag("--force", options.force, "Start even where the budget says that it does not fit");
}

} // namespace patina::tool
