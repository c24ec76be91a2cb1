// vdb-patina slice VOLUME: a core sample

#include "command_line.h"
#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "outputs.h"
#include "region_input.h"
#include "section_input.h"

#include "base/errors.h"
#include "base/units.h"
#include "render/film.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

#include <cmath>

namespace patina::tool {

namespace {

struct Arguments {
    std::string volume;
    SectionInput section;
    bool graph = false;
};

std::string nameOf(const LayerVolume& volume, int region) {
    return region < 0 ? "air" : region == 0 ? volume.metal() : volume.layers()[std::size_t(region - 1)];
}

void slice(const Arguments& arguments, const Options& options, Console& console) {
    if (options.pictureSize < 320)
        throw Error(ExitCode::commandLine, "--picture", fmt::format("{} pixels are too few", options.pictureSize),
                    "a section with its legend takes at least 320");
    const LayerVolume volume = readVolume(arguments.volume);
    const MaterialLibrary library = MaterialLibrary::load(findDataFolder());
    const std::string name = std::filesystem::path(arguments.volume).stem().string();
    const std::optional<Region> region = RegionRequest::of(volume, arguments.volume).existing;
    const SectionPicture picture =
        makeSection(volume, library, arguments.section, options.pictureSize, name, console, region);
    if (!picture.hasText)
        console.warning("no font was found on this machine: the picture has no labels");
    if (picture.cutFraction < 0.999)
        console.info(fmt::format("the surface ends within the cut: {:.0f} % of its width is drawn",
                                 100.0 * picture.cutFraction));
    const OutputFolder folder = outputFolder(options, name);
    const auto file = folder.path() / (name + "_slice.png");
    writePng(picture.image, file, {{"Software", "vdb-patina " PATINA_VERSION}});
    for (std::size_t k = picture.meanThicknessUm.size(); k-- > 0;)
        console.info(fmt::format("{:<24} {}", volume.layers()[k], readableLength(picture.meanThicknessUm[k])));
    console.result(file.string());
    if (!arguments.graph)
        return;
    const StackGraph graph =
        makeStackGraph(volume, library, arguments.section, options.pictureSize, name, console, region);
    const auto graphFile = file.parent_path() / (name + "_graph.png");
    writePng(graph.image, graphFile, {{"Software", "vdb-patina " PATINA_VERSION}});
    for (std::size_t i = graph.spans.size(); i-- > 0;) {
        const StackSpan& span = graph.spans[i];
        console.info(fmt::format("{:<24} {:.6g} to {:.6g} µm", nameOf(volume, span.region), span.fromUm, span.toUm));
    }
    console.result(graphFile.string());
}

} // namespace

void addSliceCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("slice", "A core sample: the layers in cross-section");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("VOLUME", arguments->volume, "A .vdb that `run` wrote")->required();
    const std::string group = "Section";
    command
        ->add_option("--at", arguments->section.at,
                     "Where, scene units (default: where the stack is most like its mean)")
        ->type_name("X,Y,Z")
        ->group(group);
    command->add_option("--along", arguments->section.along, "Direction from left to right (default 1,0,0)")
        ->type_name("X,Y,Z")
        ->group(group);
    command
        ->add_option("--width", arguments->section.width, "Length of the cut: µm, or with a unit (default: 48 voxels)")
        ->type_name("LENGTH")
        ->group(group);
    auto* stretch =
        command->add_option("--stretch", arguments->section.stretch, "Draw thickness so many times (default: to fit)")
            ->check(numberAboveZero())
            ->type_name("E")
            ->group(group);
    command
        ->add_flag("--in-place", arguments->section.inPlace,
                   "The plane as it is, instead of the surface unrolled and thickness stretched")
        ->excludes(stretch)
        ->group(group);
    command
        ->add_flag("--graph", arguments->graph,
                   "Also NAME_graph.png: the stack along the normal at the middle of the cut, heights in µm")
        ->group(group);
    command->add_flag("--by-id", arguments->section.byId, "A colour for each layer instead of its own")->group(group);
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
