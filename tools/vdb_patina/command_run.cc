// vdb-patina run SCRIPT [MODEL]

#include "commands.h"
#include "console.h"
#include "data_folder.h"
#include "model_input.h"
#include "outputs.h"
#include "report.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/hash.h"
#include "base/units.h"
#include "script/budget.h"
#include "script/interpreter.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <unistd.h>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

double machineMemoryBytes() { return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE)); }

void checkBudget(const Budget& budget, const Options& options, Console& console) {
    const double limit = options.budgetGiB > 0.0 ? options.budgetGiB * 1073741824.0 : 0.8 * machineMemoryBytes();
    const std::string text =
        fmt::format("budget: {:.3g} million voxels in the band, volume {}, peak memory {}, disk {}", budget.activeVoxels * 1e-6,
                    readableBytes(budget.volumeBytes), readableBytes(budget.peakBytes), readableBytes(budget.diskBytes));
    if (options.dryRun)
        console.result(text);
    else
        console.notice(text);
    if (budget.peakBytes > limit && !options.force)
        throw Error(ExitCode::budget, "budget",
                    fmt::format("the run needs about {}, {} are allowed; nothing was started", readableBytes(budget.peakBytes),
                                readableBytes(limit)),
                    "use fewer --voxels or a smaller --resolution, allow more with --budget, or --force it");
}

// An interrupted run leaves its volume and how far it got, so that --resume can go on.
struct Interruption {
    fs::path volumeFile, stateFile;
    Interruption(const fs::path& folder, const std::string& name)
        : volumeFile(folder / (name + ".interrupted.vdb")), stateFile(folder / (name + ".interrupted.json")) {}

    static std::string inputHash(const Program& program, const Model& model, const RunOptions& run) {
        ContentHash hash;
        hash.add(program.sourceText);
        for (const Parameter& parameter : program.parameters)
            hash.add(&parameter.value, sizeof parameter.value);
        hash.add(surfaceHash(model.surface));
        hash.add(&run.scale.voxelSize, sizeof run.scale.voxelSize);
        hash.add(&run.scale.exaggeration, sizeof run.scale.exaggeration);
        hash.add(&run.seed, sizeof run.seed);
        return hash.text();
    }

    void save(const RunResult& result, const std::string& inputs) const {
        if (!result.volume)
            return;
        writeVolume(*result.volume, volumeFile);
        writeTextFile(stateFile, nlohmann::json({{"inputs", inputs}, {"finished", result.finished}}).dump(2) + "\n");
    }

    std::pair<LayerVolume, std::size_t> load(const std::string& inputs) const {
        if (!fs::exists(stateFile))
            throw Error(ExitCode::commandLine, "--resume", fmt::format("there is no interrupted run in '{}'", stateFile.parent_path().string()),
                        "leave --resume out");
        const auto state = nlohmann::json::parse(readTextFile(stateFile), nullptr, false);
        if (state.is_discarded() || !state.contains("inputs") || !state.contains("finished"))
            throw RunError(stateFile.string(), "is damaged", "leave --resume out");
        if (state["inputs"] != inputs)
            throw RunError(stateFile.string(), "belongs to a run of another script, model or options", "leave --resume out");
        return {readVolume(volumeFile), state["finished"].get<std::size_t>()};
    }

    void remove() const {
        std::error_code ignored;
        fs::remove(volumeFile, ignored);
        fs::remove(stateFile, ignored);
    }
};

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

void runScript(const std::string& script, const std::string& modelName, const Options& options, Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    CheckContext context = checkContext(materials, options);
    // Once without the model: a script's errors are told before a large model is read.
    Program program = readProgramFile(script, context);
    const Model model = loadModel(modelName, options, nullptr, console);
    context.vertexAttributes.emplace();
    for (const auto& attribute : model.surface.vertexAttributes)
        context.vertexAttributes->push_back(attribute.first);
    program = readProgramFile(script, context);
    for (const Diagnostic& warning : program.warnings)
        console.warning(warning.text());

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
    const Interruption interruption(folder, program.name);
    const std::string inputs = Interruption::inputHash(program, model, run);

    std::optional<LayerVolume> resumed;
    std::size_t finished = 0;
    if (options.resume) {
        auto [volume, count] = interruption.load(inputs);
        resumed = std::move(volume);
        finished = count;
        console.notice(fmt::format("going on after {} finished statements", finished));
    }
    RunResult result = runProgram(program, model.surface, materials, run, console, std::move(resumed), finished);
    if (result.interrupted) {
        interruption.save(result, inputs);
        throw Error(ExitCode::interrupted, "run",
                    fmt::format("interrupted after {} of {} statements; what was finished is saved", result.finished,
                                program.statements.size()),
                    "go on with --resume");
    }
    warnAboutClamping(result, console);

    const LayerVolume& volume = *result.volume;
    std::vector<std::string> outputs;
    {
        const ProgressStage stage(console, "write volume");
        writeVolume(volume, folder / (program.name + ".vdb"));
        outputs.push_back(program.name + ".vdb");
    }
    const StackOptics optics = opticsOf(volume, materials, options);
    const StackStatistics stack = measureStack(volume, model.surface);
    nlohmann::ordered_json report = makeReport(program, model, options, result, stack);
    addMapsToReport(report, writeMaps(volume, model, optics, options, folder, outputs, console));
    writeMeshes(model, program.name, folder, outputs, console);
    if (options.pictureSize > 0) {
        writePicture(volume, model, optics, options, folder / "preview.png", console);
        outputs.push_back("preview.png");
    }
    const fs::path reportFile = options.report.empty() ? folder / "report.json" : fs::path(options.report);
    finishReport(report, console, outputs);
    writeTextFile(reportFile, report.dump(2) + "\n");
    interruption.remove();
    if (stack.unreadable > 1e-3)
        console.notice(fmt::format("{:.2g} % of the model's surface lies inside other parts of it, or is thinner than a voxel, and has no layers",
                                   stack.unreadable * 100.0));
    console.result(fmt::format("{}: {} layers, {:.3g} µm on average, {:.3g} µm at most; content hash {}", folder.string(),
                               volume.layerCount(), stack.total.meanUm, stack.total.maxUm,
                               report["content_hash"].get<std::string>()));
}

void checkScript(const std::string& script, const std::string& modelName, Options options, Console& console) {
    const MaterialLibrary materials = MaterialLibrary::load(findDataFolder());
    CheckContext context = checkContext(materials, options);
    Program program = readProgramFile(script, context);
    if (!modelName.empty()) {
        const Model model = loadModel(modelName, options, nullptr, console);
        context.vertexAttributes.emplace();
        for (const auto& attribute : model.surface.vertexAttributes)
            context.vertexAttributes->push_back(attribute.first);
        program = readProgramFile(script, context);
        options.dryRun = true;
        checkBudget(estimateBudget(program, model.surface, model.scale, options.resolution), options, console);
    }
    for (const Diagnostic& warning : program.warnings)
        console.warning(warning.text());
    console.result(fmt::format("{}: {} statements, no errors", program.file, program.statements.size()));
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
    command->add_option("--report", options.report, "Where the report goes (default: report.json in the folder)")->type_name("FILE");
    addModelOptions(*command, options);
    addVolumeOptions(*command, options);
    addMapOptions(*command, options);
    addPictureOptions(*command, options);
    addRunOptions(*command, options);
    command->add_flag("--resume", options.resume, "Go on with an interrupted run in the same folder");
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
