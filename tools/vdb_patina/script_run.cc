#include "script_run.h"

#include "data_folder.h"
#include "export/texel_map.h"
#include "outputs.h"
#include "picture.h"
#include "picture_budget.h"
#include "report.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "base/units.h"
#include "script/budget.h"
#include "volume/fog_file.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

double machineMemoryBytes() {
    return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
}

// Where a script goes on from a volume, that volume's scale holds, and not the command line's.
std::optional<VolumeScale> scaleOfOpened(const Program& program, const Options& options, RegionRequest& request) {
    for (const Statement& statement : program.statements)
        if (const auto* open = std::get_if<OpenFile>(&statement.action)) {
            if (!options.region.empty() || !options.regionAt.empty())
                throw Error(ExitCode::commandLine, "--region",
                            fmt::format("the script goes on from '{}', which has its own extent", open->file),
                            "leave the region out, or start the script with new");
            const LayerVolume volume = readVolume(open->file);
            request = RegionRequest::of(volume, open->file);
            return volume.scale();
        }
    return std::nullopt;
}

} // namespace

CheckContext checkContext(const MaterialLibrary& materials, const Options& options) {
    CheckContext context;
    declareAbilities(context, materials);
    context.kinetics = readKinetics(findDataFolder());
    context.settings = options.settingMap();
    const Imath::V3d up = upVector(options.up);
    context.up = {up.x, up.y, up.z};
    return context;
}

Task prepareTask(const std::string& script, const std::string& modelName, const MaterialLibrary& materials,
                 const Options& options, Console& console) {
    CheckContext context = checkContext(materials, options);
    // Once without the model: a script's errors are told before a large model is read.
    Program program = readProgramFile(script, context);
    RegionRequest region;
    const std::optional<VolumeScale> scale = scaleOfOpened(program, options, region);
    region.reachVoxels = [&](const VolumeScale& s) {
        return std::max({4.0, bandOutsideVoxels(program, s), std::ceil(deepestPitVoxels(program, s)) + 3.0});
    };
    Model model = loadModel(modelName, options, scale ? &*scale : nullptr, console, region);
    if (model.region && !model.whole)
        throw ModelError(modelName, "is the piece of a region: a script needs the whole model",
                         "give the model that the region was cut out of");
    context.vertexAttributes.emplace();
    for (const auto& attribute : model.surface.vertexAttributes)
        context.vertexAttributes->push_back(attribute.first);
    program = readProgramFile(script, context);
    for (const Diagnostic& warning : program.warnings)
        console.warning(warning);
    return {std::move(program), std::move(model)};
}

void nextScript(Task& task, const std::string& script, const MaterialLibrary& materials, const Options& options,
                Console& console) {
    CheckContext context = checkContext(materials, options);
    context.vertexAttributes.emplace();
    for (const auto& attribute : task.model.surface.vertexAttributes)
        context.vertexAttributes->push_back(attribute.first);
    task.program = readProgramFile(script, context);
    for (const Diagnostic& warning : task.program.warnings)
        console.warning(warning);
}

RunOptions runOptionsOf(const Task& task, const Options& options) {
    RunOptions run;
    run.scale = task.model.scale;
    run.longestSide = task.model.longestSide;
    run.up = upVector(options.up);
    run.seed = options.seed ? *options.seed : task.program.seed.value_or(0);
    run.programVersion = PATINA_VERSION;
    run.modelName = task.model.name;
    run.region = task.model.whole.get();
    run.context = task.model.context.get();
    return run;
}

void checkBudget(const Task& task, const Options& options, Console& console) {
    if (options.bakeMaps)
        checkCharts(task.model.surface, options.resolution); // told before a long run and not after it
    const RegionModel* whole = task.model.whole.get();
    Budget budget = estimateBudget(task.program, whole ? whole->work() : task.model.surface, task.model.scale,
                                   options.resolution, whole ? whole->whole().triangles.size() : 0);
    const int layers = mostLevelSets(task.program) - 1;
    budget.peakBytes = std::max(budget.peakBytes, budget.residentBytes + pictureBytes(options, task.model, layers));
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
                    "use fewer --voxels, a smaller --resolution or --picture, allow more with --budget, or --force it");
}

void warnAboutClamping(const RunResult& result, Console& console) {
    for (const StatementReport& statement : result.statements)
        if (statement.operation.clampedBelow + statement.operation.clampedAbove > 0)
            console.warning(fmt::format("line {}: the map left 0…1 at {} voxels and was clamped there", statement.line,
                                        statement.operation.clampedBelow + statement.operation.clampedAbove));
}

void writeResults(const Task& task, const RunResult& result, const nlohmann::ordered_json& earlier,
                  const MaterialLibrary& materials, const Options& options, const fs::path& folder, Console& console) {
    const LayerVolume& volume = *result.volume;
    const std::string& name = task.program.name;
    const fs::path reportTo = reportFile(options, folder);
    std::vector<std::string> outputs;
    {
        const ProgressStage stage(console, "write volume");
        writeVolume(volume, folder / (name + ".vdb"), volumeFileOptions(options));
        outputs.push_back(name + ".vdb");
        if (options.fog && volume.layerCount() > 0) {
            writeFog(volume, folder / (name + "_fog.vdb"), options.halfFields);
            outputs.push_back(name + "_fog.vdb");
        }
    }
    const StackOptics optics = opticsOf(volume, materials, options);
    const StackStatistics stack = measureStack(volume, task.model.surface);
    nlohmann::ordered_json report = makeReport(task.program, task.model, options, result, stack, earlier);
    if (options.bakeMaps)
        addMapsToReport(report, writeMaps(volume, task.model, optics, options, folder, outputs, console));
    writeMeshes(task.model, options, name, folder, outputs, console);
    writeMicroMesh(volume, task.model, optics, options, name, folder, outputs, console);
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
    console.result(fmt::format("{}: {} layers, {:.4g} µm on average, {:.4g} µm at most; content hash {}",
                               folder.string(), volume.layerCount(), stack.total.meanUm, stack.total.maxUm,
                               report["content_hash"].get<std::string>()));
}

} // namespace patina::tool
