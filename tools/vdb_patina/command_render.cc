// vdb-patina render VOLUME [MODEL]

#include "commands.h"
#include "console.h"
#include "existing_volume.h"
#include "outputs.h"
#include "picture.h"

#include "base/errors.h"

namespace patina::tool {

namespace {

struct Arguments {
    std::string volume;
    std::string model;
};

void renderVolume(const Arguments& arguments, const Options& given, Console& console) {
    if (given.pictureSize == 0)
        throw Error(ExitCode::commandLine, "--picture", "a picture of 0 pixels", "give its longer side in pixels");
    checkPictureSize(given);
    const ExistingVolume input = loadExisting(arguments.volume, arguments.model, given, console);
    const Options options = withUpOf(arguments.volume, given);
    const std::string name = std::filesystem::path(arguments.volume).stem().string();
    const OutputFolder folder = outputFolder(options, name);
    const StackOptics optics = opticsOf(input.volume, input.materials, options);
    const auto file = folder.path() / (name + ".png");
    writePicture(input.volume, input.model, optics, options, file, console);
    console.result(file.string());
}

} // namespace

void addRenderCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("render", "A picture of a volume");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("VOLUME", arguments->volume, "A .vdb that `run` wrote")->required();
    command->add_option("MODEL", arguments->model,
                        "The model it was made from (default: the .obj that `run` wrote beside it)");
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    addModelOptions(*command, options);
    addOpticsOptions(*command, options);
    addPictureOptions(*command, options);
    addRenderOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { renderVolume(*arguments, options, console); };
    });
}

} // namespace patina::tool
