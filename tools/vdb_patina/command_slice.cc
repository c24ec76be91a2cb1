// vdb-patina slice VOLUME: a core sample

#include "command_line.h"
#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "outputs.h"
#include "point_text.h"

#include "base/errors.h"
#include "base/units.h"
#include "optics/colour.h"
#include "render/film.h"
#include "render/section_picture.h"
#include "volume/section_sampler.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

#include <cmath>

namespace patina::tool {

namespace {

struct Arguments {
    std::string volume;
    std::string at;
    std::string along;
    std::string width;
    double stretch = 0.0;
    bool byId = false;
};

Imath::V3d pointOf(const std::string& option, const std::string& text) {
    if (const auto point = pointInText(text))
        return *point;
    throw Error(ExitCode::commandLine, option, fmt::format("'{}' is not a point", text),
                fmt::format("three coordinates, as in {} 0.1,0.2,0.05", option));
}

// A length as scripts write it: 500, 500um, 0.5mm. In µm.
double lengthOf(const std::string& text) {
    std::size_t end = 0;
    double value = 0.0;
    try {
        value = std::stod(text, &end);
    } catch (const std::exception&) {
        end = 0;
    }
    const auto unit = end == text.size() ? std::optional<double>(1.0) : micrometresPerUnit(text.substr(end));
    if (end == 0 || !unit || !(value > 0.0) || !std::isfinite(value))
        throw Error(ExitCode::commandLine, "--width", fmt::format("'{}' is not a length above 0", text),
                    "a number of micrometres, or one with its unit, as in 5mm");
    return value * *unit;
}

Imath::V3f encoded(const Imath::V3f& linear) {
    return {float(encodeSrgb(linear.x)), float(encodeSrgb(linear.y)), float(encodeSrgb(linear.z))};
}

// Hues that neighbours in the stack do not share: steps of the golden ratio around the colour circle.
Imath::V3f colourOfId(std::size_t id) {
    if (id == 0)
        return Imath::V3f(0.45f);
    const double hue = std::fmod(0.08 + double(id) * 0.6180339887, 1.0) * 6.0;
    Imath::V3f colour;
    for (int c = 0; c < 3; ++c) {
        const double distance = std::abs(std::fmod(hue + 6.0 - 2.0 * c + 3.0, 6.0) - 3.0);
        colour[c] = float(0.25 + 0.65 * std::clamp(2.0 - distance, 0.0, 1.0));
    }
    return colour;
}

void slice(const Arguments& arguments, const Options& options, Console& console) {
    if (options.pictureSize < 320)
        throw Error(ExitCode::commandLine, "--picture", fmt::format("{} pixels are too few", options.pictureSize),
                    "a section with its legend takes at least 320");
    const LayerVolume volume = readVolume(arguments.volume);
    const MaterialLibrary library = MaterialLibrary::load(findDataFolder());
    std::vector<SectionMaterial> materials;
    std::vector<std::string> names{volume.metal()};
    names.insert(names.end(), volume.layers().begin(), volume.layers().end());
    for (std::size_t k = 0; k < names.size(); ++k) {
        const Material* material = library.find(names[k]);
        materials.push_back({names[k], arguments.byId || !material ? colourOfId(k) : encoded(material->swatch)});
    }

    SectionOptions section;
    const std::string name = std::filesystem::path(arguments.volume).stem().string();
    section.title = name;
    section.pictureWidth = options.pictureSize;
    section.stretch = arguments.stretch;
    if (arguments.at.empty()) {
        section.at = SectionSampler(volume).typicalPlace().position;
        console.info(fmt::format("cut at ({:.6g}, {:.6g}, {:.6g}), where the stack is most like its mean", section.at.x,
                                 section.at.y, section.at.z));
    } else {
        section.at = pointOf("--at", arguments.at);
    }
    if (!arguments.along.empty())
        section.along = pointOf("--along", arguments.along);
    if (section.along.length() == 0.0)
        throw Error(ExitCode::commandLine, "--along", "a direction of length 0");
    if (!arguments.width.empty())
        section.width = lengthOf(arguments.width) * 1e-6 / volume.scale().metresPerUnit;

    const SectionPicture picture = drawSection(volume, materials, section);
    if (!picture.hasText)
        console.warning("no font was found on this machine: the picture has no labels");
    if (picture.cutFraction < 0.999)
        console.info(fmt::format("the surface ends within the cut: {:.0f} % of its width is drawn",
                                 100.0 * picture.cutFraction));
    const auto file = outputFolder(options, name) / (name + "_slice.png");
    writePng(picture.image, file, {{"Software", "vdb-patina " PATINA_VERSION}});
    for (std::size_t k = picture.meanThicknessUm.size(); k-- > 0;)
        console.info(fmt::format("{:<24} {}", names[k + 1], readableLength(picture.meanThicknessUm[k])));
    console.result(file.string());
}

} // namespace

void addSliceCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("slice", "A core sample: the layers in cross-section");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("VOLUME", arguments->volume, "A .vdb that `run` wrote")->required();
    const std::string group = "Section";
    command->add_option("--at", arguments->at, "Where, scene units (default: where the stack is most like its mean)")
        ->type_name("X,Y,Z")
        ->group(group);
    command->add_option("--along", arguments->along, "Direction from left to right (default 1,0,0)")
        ->type_name("X,Y,Z")
        ->group(group);
    command->add_option("--width", arguments->width, "Length of the cut: µm, or with a unit (default: 48 voxels)")
        ->type_name("LENGTH")
        ->group(group);
    command->add_option("--stretch", arguments->stretch, "Draw thickness so many times (default: to fit)")
        ->check(numberAboveZero())
        ->type_name("E")
        ->group(group);
    command->add_flag("--by-id", arguments->byId, "A colour for each layer instead of its own")->group(group);
    command->add_option("--picture", options.pictureSize, "Pixels across (default 640)")
        ->check(wholeNumberWithin(0, 16384))
        ->type_name("P")
        ->group(group);
    addOutputOption(*command, options);
    addGeneralOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { slice(*arguments, options, console); };
    });
}

} // namespace patina::tool
