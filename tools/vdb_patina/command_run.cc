// vdb-patina run SCRIPT [MODEL]

#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "interrupted_run.h"
#include "model_input.h"
#include "outputs.h"
#include "report.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/units.h"
#include "script/budget.h"
#include "script/interpreter.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <unistd.h>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

double machineMemoryBytes() {
    return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
}

void checkBudget(const Budget& budget, const Options& options, Console& console) {
    const double limit = options.budgetGiB > 0.0 ? options.budgetGiB * 1073741824.0 : 0.8 * machineMemoryBytes();
    const std::string text = fmt::format(
        "budget: {:.3g} million voxels in the band, volume {}, peak memory {}, disk {}", budget.activeVoxels * 1e-6,
        readableBytes(budget.volumeBytes), readableBytes(budget.peakBytes), readableBytes(budget.diskBytes));
    if (options.dryRun)
        console.result(text);
    else
        console.notice(text);
    if (budget.peakBytes > limit && !options.force)
        throw Error(ExitCode::budget, "budget",
                    fmt::format("the run needs about {}, {} are allowed; nothing was started",
                                readableBytes(budget.peakBytes), readableBytes(limit)),
                    "use fewer --voxels or a smaller --resolution, allow more with --budget, or --force it");
}

CheckContext checkContext(const MaterialLibrary& materials, const Options& options) {
    CheckContext context;
    declareAbilities(context, materials);
    context.settings = options.settingMap();
    return context;
}

void warnAboutClamping(const RunResult& result, Console& console) {
    for (const StatementReport& statement : result.statements)
        if (statement.operation.clampedBelow + statement.operation.clampedAbove > 0)
            console.warning(fmt::format("line {}: the map left 0…1 at {} voxels and was clamped there", statement.line,
                                        statement.operation.clampedBelow + statement.operation.clampedAbove));
}

// Where a script goes on from a volume, that volume's scale holds, and not the command line's.
std::optional<VolumeScale> scaleOfOpened(const Program& program) {
    for (const Statement& statement : program.statements)
        if (const auto* open = std::get_if<OpenFile>(&statement.action))
            return readVolume(open->file).scale();
    return std::nullopt;
}

struct Task {
    Program program;
    Model model;
};

// Everything that can be wrong with script, model and both together is told here, before anything is written.
Task prepare(const std::string& script, const std::string& modelName, const MaterialLibrary& materials,
             const Options& options, Console& console) {
    CheckContext context = checkContext(materials, options);
    // Once without the model: a script's errors are told before a large model is read.
    Program program = readProgramFile(script, context);
    const std::optional<VolumeScale> scale = scaleOfOpened(program);
    Model model = loadModel(modelName, options, scale ? &*scale : nullptr, console);
    context.vertexAttributes.emplace();
    for (const auto& attribute : model.surface.vertexAttributes)
        context.vertexAttributes->push_back(attribute.first);
    program = readProgramFile(script, context);
    for (const Diagnostic& warning : program.warnings)
        console.warning(warning);
    return {std::move(program), std::move(model)};
}

fs::path reportFile(const Options& options, const fs::path& folder) {
    if (options.report.empty())
        return folder / "report.json";
    // Not only found out when all is done.
    if (fs::is_directory(options.report))
        throw RunError(options.report, "is a folder", "--report takes the name of a file");
    const AtomicFile writable(options.report);
    return options.report;
}

// Maps, meshes, picture and report of a volume that is done.
void writeResults(const Task& task, const RunResult& result, const nlohmann::ordered_json& earlier,
                  const MaterialLibrary& materials, const Options& options, const fs::path& folder, Console& console) {
    const LayerVolume& volume = *result.volume;
    const std::string& name = task.program.name;
    const fs::path reportTo = reportFile(options, folder);
    std::vector<std::string> outputs;
    {
        const ProgressStage stage(console, "write volume");
        writeVolume(volume, folder / (name + ".vdb"));
        outputs.push_back(name + ".vdb");
    }
    const StackOptics optics = opticsOf(volume, materials, options);
    const StackStatistics stack = measureStack(volume, task.model.surface);
    nlohmann::ordered_json report = makeReport(task.program, task.model, options, result, stack, earlier);
    addMapsToReport(report, writeMaps(volume, task.model, optics, options, folder, outputs, console));
    writeMeshes(task.model, name, folder, outputs, console);
    if (options.pictureSize > 0) {
        writePicture(volume, task.model, optics, options, folder / "preview.png", console);
        outputs.push_back("preview.png");
    }
    if (stack.unreadable > 1e-3)
        console.notice(fmt::format("{:.2g} % of the model's surface lies inside other parts of it, or is thinner than "
                                   "a voxel, and has no layers",
                                   stack.unreadable * 100.0));
    finishReport(report, console, outputs);
    writeTextFile(reportTo, report.dump(2) + "\n");
    console.result(fmt::format("{}: {} layers, {:.3g} µm on average, {:.3g} µm at most; content hash {}",
                               folder.string(), volume.layerCount(), stack.total.meanUm, stack.total.maxUm,
                               report["content_hash"].get<std::string>()));
}

void runScript(const std::string& script, const std::string& modelName, const Options& options, Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    const Task task = prepare(script, modelName, materials, options, console);
    const auto& [program, model] = task;

    RunOptions run;
    run.scale = model.scale;
    run.longestSide = model.longestSide;
    run.up = upVector(options.up);
    run.seed = options.seed ? *options.seed : program.seed.value_or(0);
    run.programVersion = PATINA_VERSION;
    run.modelName = model.name;

    checkBudget(estimateBudget(program, model.surface, model.scale, options.resolution), options, console);
    if (options.dryRun)
        return;
    const fs::path folder = outputFolder(options, program.name);
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
    const auto [program, model] = prepare(script, modelName, materials, options, console);
    console.result(fmt::format("{}: {} statements, no errors", program.file, program.statements.size()));
    options.dryRun = true; // the budget is the result
    checkBudget(estimateBudget(program, model.surface, model.scale, options.resolution), options, console);
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
    addMapOptions(*command, options);
    addRunOptions(*command, options);
    command->callback([&options, &action, arguments] {
        action = [&options, arguments](Console& console) {
            checkScript(arguments->script, arguments->model, options, console);
        };
    });
}

} // namespace patina::tool
