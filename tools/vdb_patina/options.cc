#include "options.h"

#include "command_line.h"

#include "base/errors.h"
#include "base/units.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

const std::map<std::string, ProgressStyle> progressStyles = {{"auto", ProgressStyle::automatic},
                                                             {"bar", ProgressStyle::bar},
                                                             {"plain", ProgressStyle::plain},
                                                             {"json", ProgressStyle::json},
                                                             {"none", ProgressStyle::none}};

} // namespace

double Options::metresPerUnit() const {
    return *micrometresPerUnit(unit) * 1e-6;
}

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
    const std::string group = "General";
    // Help stands with the others.
    app.set_help_flag("-h,--help", "Print this and end")->group(group);
    app.add_option("--threads", options.threads, "Threads to use; the result does not depend on them (default: all)")
        ->check(wholeNumberWithin(1, 1024))
        ->type_name("T")
        ->group(group);
    app.add_option_function<std::string>(
           "--progress", [&options](const std::string& word) { options.progress = progressStyles.at(word); },
           "How to show it, on stderr: auto, bar, plain, json or none (default: a bar on a terminal)")
        ->check(oneOf({"auto", "bar", "plain", "json", "none"}))
        ->type_name("STYLE")
        ->group(group);
    auto* verbose = app.add_flag("-v,--verbose", options.verbose, "Say more")->group(group);
    app.add_flag("-q,--quiet", options.quiet, "Say only what went wrong")->excludes(verbose)->group(group);
}

void addOutputOption(CLI::App& app, Options& options) {
    app.add_option("-o,--output", options.output,
                   "Folder for the results, made if needed (default: named after the result)")
        ->type_name("DIR")
        ->group("Results");
}

void addModelOptions(CLI::App& app, Options& options) {
    const std::string group = "Model";
    app.add_option("--unit", options.unit, "Unit of the model's coordinates: m, cm, mm or um (default m)")
        ->check(oneOf({"m", "cm", "mm", "um"}))
        ->type_name("UNIT")
        ->group(group);
    app.add_option_function<std::string>(
           "--up",
           [&options](const std::string& word) {
               options.up = word == "z" ? UpAxis::z : UpAxis::y;
               options.upGiven = true;
           },
           "The model's up axis: y or z (default: the volume's, or y)")
        ->check(oneOf({"y", "z"}))
        ->type_name("AXIS")
        ->group(group);
    app.add_option("--scheme", options.scheme,
                   "Subdivision: automatic, none, catmull-clark or loop (default automatic)")
        ->check(oneOf({"automatic", "none", "catmull-clark", "loop"}))
        ->type_name("NAME")
        ->group(group);
    app.add_option("--subdivide", options.subdivide, "Level of subdivision (default: until edges are about a voxel)")
        ->check(wholeNumberWithin(0, 7))
        ->type_name("L")
        ->group(group);
    app.add_option("--repair", options.repair,
                   "Holes of models: auto closes those of what has an inside, holes all, sheet none; none: refuse them")
        ->check(oneOf({"auto", "holes", "sheet", "none"}))
        ->type_name("HOW")
        ->group(group);
    app.add_flag("--atlas", options.atlas, "Replace the UVs: a tile for each face, charts for scans")->group(group);
}

void addVolumeOptions(CLI::App& app, Options& options) {
    const std::string group = "Volume";
    auto* voxels = app.add_option("--voxels", options.voxels, "Voxels along the model's longest side (default 256)")
                       ->check(wholeNumberWithin(8, 65536))
                       ->type_name("N")
                       ->group(group);
    app.add_option("--voxel-size", options.voxelSize, "Size of a voxel in scene units, instead of --voxels")
        ->check(numberAboveZero())
        ->excludes(voxels)
        ->type_name("X")
        ->group(group);
    app.add_option("--exaggeration", options.exaggeration, "Draw thickness so many times life size (default 1)")
        ->check(numberAboveZero())
        ->type_name("E")
        ->group(group);
    app.add_option("--seed", options.seed, "Seed of all randomness (default: the script's, or 0)")
        ->check(wholeNumberWithin(0, 9007199254740992))
        ->type_name("S")
        ->group(group);
    app.add_flag("--half-fields", options.halfFields, "Fields of the .vdb in half precision; level sets stay single")
        ->group(group);
    app.add_flag("--fog", options.fog,
                 "Also write NAME_fog.vdb: how much of each voxel each layer fills, for fog shaders")
        ->group(group);
}

void addRegionOptions(CLI::App& app, Options& options) {
    const std::string group = "Close-up";
    auto* box =
        app.add_option("--region", options.region,
                       "A box of the model alone, two opposite corners in scene units; --voxels is along its side")
            ->type_name("X0,Y0,Z0,X1,Y1,Z1")
            ->group(group);
    app.add_option("--region-at", options.regionAt, "The same as a cube: its middle and the length of its sides")
        ->excludes(box)
        ->type_name("X,Y,Z,SIZE")
        ->group(group);
    app.add_option("--context", options.context, "A .vdb of the whole model: its fields hold for the region")
        ->type_name("WHOLE.vdb")
        ->group(group);
}

void addOpticsOptions(CLI::App& app, Options& options) {
    const std::string group = "Optics";
    app.add_option("--optics", options.optics, "conserving (default) or paper (its section 4.3 to the letter)")
        ->check(oneOf({"conserving", "paper"}))
        ->type_name("MODEL")
        ->group(group);
    app.add_flag("--thin-film", options.thinFilm,
                 "Interference colours where an oxide on the metal is thinner than 150 nm: its first weeks")
        ->group(group);
}

void addMapOptions(CLI::App& app, Options& options) {
    const std::string group = "Maps";
    app.add_option("--resolution", options.resolution, "Texels along a side of the maps (default 1024)")
        ->check(wholeNumberWithin(16, 32768))
        ->type_name("P")
        ->group(group);
    app.add_flag("--keep-exaggeration", options.keepExaggeration, "Displacement as drawn in the volume, not real")
        ->group(group);
    app.add_flag("--material-id", options.materialId, "Also bake material_id.exr")->group(group);
    app.add_flag("--fold-mask", options.foldMask, "Also bake fold_mask.exr: where a height map cannot follow")
        ->group(group);
    app.add_flag("--vector-displacement", options.vectorDisplacement,
                 "Also bake vector_displacement.exr: follows overhangs")
        ->group(group);
    app.add_option("--vector-space", options.vectorSpace,
                   "Its channels: object (x, y, z; default), blender (T, N, B) or materialx (dPdu, dPdv, N)")
        ->check(oneOf({"object", "blender", "materialx"}))
        ->type_name("SPACE")
        ->group(group);
    app.add_flag("--micro-mesh", options.microMesh,
                 "Also write NAME_micro.ply: the displaced surface, with thickness, ID and colour per vertex")
        ->group(group);
    app.add_flag("--fields", options.fields, "Also bake field_exposure.exr, … of every field in the volume")
        ->group(group);
    app.add_flag("--tx", options.tx, "Also write each map as tiled, mip-mapped .tx")->group(group);
    addOpticsOptions(app, options);
    app.add_option("--colour-space", options.colourSpace, "Of the colour maps: rec709 (default) or acescg; linear")
        ->check(oneOf({"rec709", "acescg"}))
        ->type_name("SPACE")
        ->group(group);
}

void addPictureOptions(CLI::App& app, Options& options, const PictureDefaults& defaults) {
    const std::string group = "Picture";
    app.add_option("--picture", options.pictureSize,
                   fmt::format("Pixels along its longer side; 0: no picture (default {})", defaults.size))
        ->check(wholeNumberWithin(0, 16384))
        ->type_name("P")
        ->group(group);
    app.add_option("--samples", options.samples, fmt::format("Paths per pixel (default {})", defaults.samples))
        ->check(wholeNumberWithin(1, 65536))
        ->type_name("N")
        ->group(group);
    app.add_option("--noise", options.noise,
                   fmt::format("Fewer paths where the noise is below so many steps of 8 bits; 0: all everywhere "
                               "(default {:g})",
                               defaults.noise))
        ->check(numberWithin(0.0, 255.0))
        ->type_name("STEPS")
        ->group(group);
    app.add_option("--azimuth", options.azimuth, "Where the camera stands, degrees around the model from its front")
        ->check(numberWithin(-360.0, 360.0))
        ->type_name("DEG")
        ->group(group);
    app.add_option("--elevation", options.elevation, "… and above the horizon, degrees")
        ->check(numberWithin(-89.0, 89.0))
        ->type_name("DEG")
        ->group(group);
}

void addRenderOptions(CLI::App& app, Options& options) {
    const std::string camera = "Camera", light = "Light", files = "Files";
    app.add_option("--from", options.from,
                   "The surface shown: mesh (the model, displaced; default) or volume (the voxels' own)")
        ->check(oneOf({"mesh", "volume"}))
        ->type_name("WHAT")
        ->group("Picture");
    app.add_option("--dice", options.dice,
                   "Longest edge of the shown mesh in view, pixels (default 1; 0: the model's own triangles)")
        ->check(numberWithin(0.0, 1000.0))
        ->type_name("PIXELS")
        ->group("Picture");
    app.add_option("--time", options.seconds, "Take as many samples as fit into so many seconds, --samples at most")
        ->check(numberAboveZero())
        ->type_name("SECONDS")
        ->group("Picture");
    app.add_option("--clamp", options.clamp,
                   "Most that light of two bounces or more adds to a path (default 6; 0: no bound, more fireflies)")
        ->check(numberWithin(0.0, 1e6))
        ->type_name("X")
        ->group("Picture");
    app.add_option("--aspect", options.aspect, "Width over height (default: the subject's)")
        ->check(numberWithin(0.05, 20.0))
        ->type_name("X")
        ->group("Picture");
    app.add_option("--camera", options.camera,
                   "Degrees around the model and above the horizon, scene units from its middle, field of view")
        ->type_name("AZ,EL[,DISTANCE[,FOV]]")
        ->group(camera);
    app.add_option("--closeup", options.closeUp,
                   "Fill the picture with a patch: a point near the surface, the patch's side")
        ->type_name("X,Y,Z,SIZE")
        ->group(camera);
    app.add_option("--f-stop", options.fStop,
                   "Depth of field of a full-frame lens at this stop, focused on the picture's middle")
        ->check(numberWithin(0.5, 256.0))
        ->type_name("N")
        ->group(camera);
    app.add_option("--light", options.light,
                   "studio (default), sky (sun and clear sky), overcast, uniform, or a panorama (EXR, HDR)")
        ->type_name("NAME|FILE")
        ->group(light);
    app.add_option("--sun", options.sun, "Where it stands for --light sky, degrees (default -50,40)")
        ->type_name("AZ,ALT")
        ->group(light);
    app.add_option("--turn-light", options.turnLight, "Turns all light about the up axis, degrees")
        ->check(numberWithin(-360.0, 360.0))
        ->type_name("DEG")
        ->group(light);
    app.add_option("--light-strength", options.lightStrength, "Factor on a panorama's or uniform light (default 1)")
        ->check(numberWithin(0.0, 1e6))
        ->type_name("X")
        ->group(light);
    app.add_flag_callback("--no-floor", [&options] { options.floor = false; },
                          "Without a floor: the light itself is the background")
        ->group(light);
    app.add_flag("--exr", options.exr,
                 "Also NAME.exr: light, albedo, N, Z, A, material (0 metal, k layer k), thickness in µm")
        ->group(files);
    app.add_option("--view", options.viewTransform,
                   "How light becomes the PNG: filmic (default) or srgb (clipped at white)")
        ->check(oneOf({"filmic", "srgb"}))
        ->type_name("NAME")
        ->group(files);
    app.add_option("--exposure", options.exposureStops, "Of the PNG, in stops (default 0)")
        ->check(numberWithin(-20.0, 20.0))
        ->type_name("STOPS")
        ->group(files);
}

void takeDefaults(const CLI::App& app, const PictureDefaults& defaults, Options& options) {
    if (app.count("--picture") == 0)
        options.pictureSize = defaults.size;
    if (app.count("--samples") == 0)
        options.samples = defaults.samples;
    if (app.count("--noise") == 0)
        options.noise = defaults.noise;
}

void addRunOptions(CLI::App& app, Options& options) {
    const std::string group = "Run";
    app.add_option("--set", options.settings, "Value of a script's parameter; may be given several times")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false)
        ->group(group);
    app.add_option("--budget", options.budgetGiB,
                   "Memory the run may take, GiB (default: four fifths of the machine's)")
        ->check(numberAboveZero())
        ->type_name("GIB")
        ->group(group);
    app.add_flag("--dry-run", options.dryRun, "Check everything and print the budget, run nothing")->group(group);
    app.add_flag("--force", options.force, "Start even where the budget says that it does not fit")->group(group);
}

} // namespace patina::tool
