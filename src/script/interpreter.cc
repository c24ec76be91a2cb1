#include "script/interpreter.h"

#include "base/hash.h"
#include "operators/coat.h"
#include "operators/erode.h"
#include "script/map_builder.h"
#include "volume/vdb_file.h"
#include "volume/voxelize.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace patina {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// The volume under way and what operators need beside it.
class Run {
  public:
    Run(const Program& program, const SurfaceMesh& surface, const MaterialLibrary& materials, const RunOptions& options,
        Progress& progress)
        : program_(program), surface_(surface), materials_(materials), options_(options), progress_(progress) {}

    RunResult go(std::optional<LayerVolume> resume, std::size_t finished) {
        if (resume) {
            adopt(std::move(*resume));
            result_.finished = finished;
        }
        try {
            for (std::size_t i = result_.finished; i < program_.statements.size(); ++i) {
                progress_.checkpoint();
                execute(program_.statements[i]);
                result_.finished = i + 1;
            }
        } catch (const Interrupted&) {
            result_.interrupted = true;
        }
        if (volume_) {
            describe(*volume_);
            result_.volume = std::move(*volume_);
        }
        return std::move(result_);
    }

  private:
    void execute(const Statement& statement) {
        const ProgressStage stage(progress_, statement.text);
        const auto start = Clock::now();
        StatementReport report;
        report.text = statement.text;
        report.line = statement.place.line;
        std::visit([&](const auto& action) { perform(action, report); }, statement.action);
        report.seconds = secondsSince(start);
        if (volume_ && volume_->layerCount() > 0)
            report.stack = measureStack(*volume_, surface_).total;
        result_.statements.push_back(std::move(report));
    }

    void perform(const NewMetal& action, StatementReport&) {
        const auto start = Clock::now();
        const ClosedSurface closed = closeSurface(surface_, sheetBackVoxels * options_.scale.voxelSize);
        VoxelizeOptions voxelizeOptions;
        voxelizeOptions.scale = options_.scale;
        voxelizeOptions.metal = action.metal;
        voxelizeOptions.exteriorBand = std::max(4.0, std::ceil(thickestStackVoxels(program_, options_.scale)) + 3.0);
        volume_ = std::make_unique<LayerVolume>(voxelize(closed, voxelizeOptions, progress_));
        bind(closed);
        binding_->refineBase(*volume_);
        result_.voxelizeSeconds += secondsSince(start);
    }

    void perform(const OpenFile& action, StatementReport&) {
        LayerVolume volume = readVolume(action.file);
        const std::string hash = surfaceHash(surface_);
        if (!volume.provenance.modelHash.empty() && volume.provenance.modelHash != hash)
            throw ModelError(
                options_.modelName,
                fmt::format("is not the model that '{}' was made from ({})", action.file, volume.provenance.model),
                "give the same model, with the same --subdivide and voxel size");
        adopt(std::move(volume));
    }

    void perform(const Coat& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        Workpiece work{*volume_, *binding_};
        report.operation = coat(work, action.material, action.thicknessUm, map.get(), progress_);
        report.growths = maps_->takeStatistics();
    }

    void perform(const Erode& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        LayerHardness hardness;
        if (action.byHardness)
            for (const std::string& layer : volume_->layers())
                hardness.push_back(materials_.at(layer).hardness);
        Workpiece work{*volume_, *binding_};
        report.operation = erode(work, action.thicknessUm, map.get(), hardness, progress_);
        report.growths = maps_->takeStatistics();
    }

    // `render maps` says that maps are wanted; they are baked from the finished volume.
    void perform(const Render&, StatementReport&) {}

    // What declareAbilities() does not list, the checker has refused before anything ran.
    template <typename Action>
    void perform(const Action&, StatementReport& report) {
        throw RunError(report.text, "this statement is not available in this version");
    }

    ThicknessMapPtr mapOf(const std::optional<Expression>& expression) {
        return expression ? maps_->build(*expression, progress_) : nullptr;
    }

    void adopt(LayerVolume volume) {
        volume_ = std::make_unique<LayerVolume>(std::move(volume));
        bind(closeSurface(surface_, sheetBackVoxels * volume_->scale().voxelSize));
    }

    void bind(const ClosedSurface& closed) {
        binding_ = std::make_unique<SurfaceBinding>(*volume_, surface_, closed);
        MapContext context;
        context.binding = binding_.get();
        context.unitsPerRealUm = 1e-6 / volume_->scale().metresPerUnit;
        context.voxelSize = volume_->scale().voxelSize;
        context.longestSide = options_.longestSide;
        context.up = options_.up;
        context.seed = options_.seed;
        maps_ = std::make_unique<MapBuilder>(context);
    }

    void describe(LayerVolume& volume) const {
        auto& from = volume.provenance;
        from.script = program_.sourceText;
        from.scriptName = program_.name;
        from.model = options_.modelName;
        from.modelHash = surfaceHash(surface_);
        from.program = options_.programVersion;
        from.seed = options_.seed;
    }

    const Program& program_;
    const SurfaceMesh& surface_;
    const MaterialLibrary& materials_;
    const RunOptions& options_;
    Progress& progress_;
    std::unique_ptr<LayerVolume> volume_;
    std::unique_ptr<SurfaceBinding> binding_;
    std::unique_ptr<MapBuilder> maps_;
    RunResult result_;
};

} // namespace

double thickestStackVoxels(const Program& program, const VolumeScale& scale) {
    double totalUm = 0.0;
    for (const Statement& statement : program.statements)
        if (const auto* coat = std::get_if<Coat>(&statement.action))
            totalUm += coat->thicknessUm;
    return totalUm * scale.voxelsPerUm();
}

void declareAbilities(CheckContext& context, const MaterialLibrary& materials) {
    for (const std::string& name : materials.names())
        context.materials.push_back({name, materials.at(name).isMetal});
    context.operators = {"new", "open", "coat", "erode", "render"};
    context.functions = {"texture", "vertices", "noise", "turbulence", "slope", "elevation", "facing",
                         "min",     "max",      "clamp", "mix",        "pow",   "smoothstep"};
    context.clauses = {"by"};
}

RunResult runProgram(const Program& program, const SurfaceMesh& surface, const MaterialLibrary& materials,
                     const RunOptions& options, Progress& progress, std::optional<LayerVolume> resume,
                     std::size_t finished) {
    return Run(program, surface, materials, options, progress).go(std::move(resume), finished);
}

std::string surfaceHash(const SurfaceMesh& surface) {
    ContentHash hash;
    hash.add(surface.positions.data(), surface.positions.size() * sizeof(Imath::V3f));
    hash.add(surface.triangles.data(), surface.triangles.size() * sizeof(Imath::V3i));
    return hash.text();
}

} // namespace patina
