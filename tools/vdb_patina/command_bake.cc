// vdb-patina bake VOLUME [MODEL]

#include "base/atomic_file.h"
#include "commands.h"
#include "console.h"
#include "existing_volume.h"
#include "outputs.h"
#include "report.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

struct Arguments {
    std::string volume;
    std::string model;
};

void bakeVolume(const Arguments& arguments, const Options& given, Console& console) {
    const ExistingVolume input = loadExisting(arguments.volume, arguments.model, given, console);
    const Options options = withUpOf(arguments.volume, given);
    const std::string name = std::filesystem::path(arguments.volume).stem().string();
    const OutputFolder output = outputFolder(options, name);
    const auto& folder = output.path();
    // The report of the run stays beside its volume.
    std::error_code ignored;
    const bool besideVolume =
        std::filesystem::equivalent(folder, std::filesystem::absolute(arguments.volume).parent_path(), ignored);
    const auto reportTo = reportFile(options, folder, besideVolume ? "bake_report.json" : "report.json");
    std::vector<std::string> outputs;
    const StackOptics optics = opticsOf(input.volume, input.materials, options);
    const BakeSummary summary =
        writeMaps(input.volume, input.model, optics, options, folder, outputs, console, arguments.volume);
    writeMeshes(input.model, options, name, folder, outputs, console);
    writeMicroMesh(input.volume, input.model, optics, options, name, folder, outputs, console);
    nlohmann::ordered_json report = makeBakeReport(arguments.volume, input.volume, input.model, options);
    addMapsToReport(report, summary);
    finishReport(report, console, outputs);
    writeTextFile(reportTo, report.dump(2) + "\n");
    console.result(fmt::format("{}: {} files, displacement at most {:.4g} scene units", folder.string(), outputs.size(),
                               summary.maxDisplacement));
}

} // namespace

void addBakeCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("bake", "Maps and subdivided mesh from a volume");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("VOLUME", arguments->volume, "A .vdb that `run` wrote")->required();
    command->add_option("MODEL", arguments->model,
                        "The model it was made from (default: the .obj that `run` wrote beside it)");
    command
        ->add_option("--report", options.report,
                     "Where the report goes (default: report.json in the folder, bake_report.json in the volume's)")
        ->type_name("FILE")
        ->group("Results");
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    addModelOptions(*command, options);
    addMapOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) { bakeVolume(*arguments, options, console); };
    });
}

} // namespace patina::tool
