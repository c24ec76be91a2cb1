// vdb-patina run SCRIPT [MODEL]

#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "interrupted_run.h"
#include "outputs.h"
#include "report.h"
#include "script_run.h"

#include "base/errors.h"

#include <fmt/format.h>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

void runScript(const std::string& script, const std::string& modelName, const Options& options, Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    const Task task = prepareTask(script, modelName, materials, options, console);
    const auto& [program, model] = task;

    const RunOptions run = runOptionsOf(task, options);
    checkBudget(task, options, console);
    if (options.dryRun)
        return;
    const OutputFolder output = outputFolder(options, program.name);
    const fs::path& folder = output.path();
    reportFile(options, folder);
    const InterruptedRun interruption(folder, program.name);
    const std::string inputs = hashOfInputs(program, model, run);

    std::optional<LayerVolume> resumed;
    std::size_t finished = 0;
    nlohmann::ordered_json earlier = nlohmann::ordered_json::array();
    if (options.resume) {
        InterruptedRun::State state = interruption.load(inputs);
        resumed = std::move(state.volume);
        finished = state.finished;
        earlier = std::move(state.statements);
        console.notice(fmt::format("going on after {} of {} statements", finished, program.statements.size()));
    }
    RunResult result = runProgram(program, model.surface, materials, run, console, std::move(resumed), finished);
    bool interrupted = result.interrupted;
    if (!interrupted) {
        warnAboutClamping(result, console);
        try {
            writeResults(task, result, earlier, materials, options, folder, console);
        } catch (const Interrupted&) {
            interrupted = true;
        }
    }
    if (!interrupted) {
        interruption.remove();
        return;
    }
    for (auto& statement : describeStatements(result.statements))
        earlier.push_back(std::move(statement));
    const std::string how =
        fmt::format("interrupted after {} of {} statements", result.finished, program.statements.size());
    if (interruption.save(result, earlier, inputs))
        throw Error(ExitCode::interrupted, "run", how + "; what was finished is saved",
                    "the same command with --resume goes on from there");
    throw Error(ExitCode::interrupted, "run", how + "; there was nothing to save yet");
}

void checkScript(const std::string& script, const std::string& modelName, Options options, Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    if (modelName.empty()) {
        const Program program = readProgramFile(script, checkContext(materials, options));
        for (const Diagnostic& warning : program.warnings)
            console.warning(warning);
        console.result(fmt::format("{}: {} statements, no errors", program.file, program.statements.size()));
        return;
    }
    const Task task = prepareTask(script, modelName, materials, options, console);
    console.result(fmt::format("{}: {} statements, no errors", task.program.file, task.program.statements.size()));
    options.dryRun = true; // the budget is the result
    checkBudget(task, options, console);
}

struct Arguments {
    std::string script;
    std::string model;
};

} // namespace

void addRunCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("run", "Run a script on a model: volume, maps, meshes, picture, report");
    auto arguments = std::make_shared<Arguments>();
    arguments->model = "strip";
    command->add_option("SCRIPT", arguments->script, "The script (docs/language.md)")->required();
    command->add_option("MODEL", arguments->model, "OBJ, PLY, STL or OFF file, or a shape of `make` (default: strip)");
    addGeneralOptions(*command, options);
    addOutputOption(*command, options);
    command->add_option("--report", options.report, "Where the report goes (default: report.json in the folder)")
        ->type_name("FILE")
        ->group("Results");
    addModelOptions(*command, options);
    addVolumeOptions(*command, options);
    addRegionOptions(*command, options);
    addMapOptions(*command, options);
    addPictureOptions(*command, options);
    addRunOptions(*command, options);
    command->add_flag("--resume", options.resume, "Go on with an interrupted run in the same folder")->group("Run");
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) {
            runScript(arguments->script, arguments->model, options, console);
        };
    });
}

void addCheckCommand(CLI::App& app, Options& options, Action& action) {
    CLI::App* command = app.add_subcommand("check", "Errors, warnings and, with a model, the budget, without running");
    auto arguments = std::make_shared<Arguments>();
    command->add_option("SCRIPT", arguments->script, "The script")->required();
    command->add_option("MODEL", arguments->model, "The model, for the budget");
    addGeneralOptions(*command, options);
    addModelOptions(*command, options);
    addVolumeOptions(*command, options);
    addRegionOptions(*command, options);
    addMapOptions(*command, options);
    addRunOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) {
            checkScript(arguments->script, arguments->model, options, console);
        };
    });
}

} // namespace patina::tool
