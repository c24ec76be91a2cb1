#include "script/interpreter.h"

#include "base/hash.h"
#include "operators/coat.h"
#include "operators/convert.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/grow_layer.h"
#include "operators/material_ratio.h"
#include "operators/offset.h"
#include "operators/offset_tangent_sphere.h"
#include "operators/polish.h"
#include "operators/maps/shifted_map.h"
#include "script/map_builder.h"
#include "volume/region_voxelize.h"
#include "volume/vdb_file.h"
#include "volume/voxelize.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace patina {

struct RunSession::Kept {
    std::filesystem::path file; ///< empty until the volume is given back
    const SurfaceMesh* surface = nullptr;
    std::unique_ptr<LayerVolume> volume; ///< binding and maps point to it
    std::unique_ptr<SurfaceBinding> binding;
    std::unique_ptr<MapBuilder> maps;
};

RunSession::RunSession() = default;
RunSession::~RunSession() = default;

void RunSession::keep(const std::filesystem::path& file, LayerVolume volume) {
    if (!kept)
        return;
    *kept->volume = std::move(volume);
    kept->file = std::filesystem::weakly_canonical(file);
}

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
            leaveToNext();
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
        // A step of a curve that does not rise changes nothing, and what was measured before holds.
        if (!isNothing(statement)) {
            std::visit([&](const auto& action) { perform(action, report); }, statement.action);
            stack_.reset();
        }
        report.seconds = secondsSince(start);
        if (!stack_ && volume_ && volume_->layerCount() > 0)
            stack_ = measureStack(*volume_, surface_, trianglesPerVoxel()).total;
        report.stack = stack_.value_or(LayerStatistics());
        result_.statements.push_back(std::move(report));
    }

    // Triangles much smaller than a voxel read the same again and again: after each statement one to a voxel's area is
    // enough, and the report's last word, by all of them, comes from the finished volume.
    std::size_t trianglesPerVoxel() const {
        const double voxel = volume_->scale().voxelSize;
        const double each = surface_.area() / double(std::max<std::size_t>(surface_.triangles.size(), 1));
        return each > 0.0 ? std::size_t(std::clamp(voxel * voxel / each, 1.0, 1e6)) : 1;
    }

    static bool isNothing(const Statement& statement) {
        const auto isZero = [](const auto* action) { return action && action->thicknessUm == 0.0; };
        return isZero(std::get_if<Coat>(&statement.action)) || isZero(std::get_if<Grow>(&statement.action)) ||
               isZero(std::get_if<Erode>(&statement.action));
    }

    void perform(const NewMetal& action, StatementReport&) {
        const auto start = Clock::now();
        const ClosedSurface closed = closeSurface(workSurface(), sheetBackVoxels * options_.scale.voxelSize);
        VoxelizeOptions voxelizeOptions;
        voxelizeOptions.scale = options_.scale;
        voxelizeOptions.metal = action.metal;
        voxelizeOptions.exteriorBand = bandOutsideVoxels(program_, options_.scale);
        voxelizeOptions.interiorBand = std::max(4.0, std::ceil(deepestPitVoxels(program_, options_.scale)) + 3.0);
        volume_ = std::make_unique<LayerVolume>(
            options_.region ? voxelizeRegion(closed, options_.region->region(), voxelizeOptions, progress_)
                            : voxelize(closed, voxelizeOptions, progress_));
        bind(closed);
        binding_->refineBase(*volume_);
        result_.voxelizeSeconds += secondsSince(start);
    }

    void leaveToNext() {
        if (!options_.session)
            return;
        options_.session->kept.reset();
        if (result_.interrupted)
            return;
        options_.session->kept = std::make_unique<RunSession::Kept>();
        RunSession::Kept& kept = *options_.session->kept;
        kept.surface = &surface_;
        kept.volume = std::move(volume_);
        kept.binding = std::move(binding_);
        kept.maps = std::move(maps_);
    }

    bool takeFromLast(const std::string& file) {
        if (!options_.session || !options_.session->kept)
            return false;
        const auto kept = std::move(options_.session->kept);
        if (kept->file.empty() || kept->surface != &surface_ || kept->file != std::filesystem::weakly_canonical(file))
            return false;
        volume_ = std::move(kept->volume);
        binding_ = std::move(kept->binding);
        maps_ = std::move(kept->maps);
        return true;
    }

    void perform(const OpenFile& action, StatementReport&) {
        if (takeFromLast(action.file))
            return;
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
        Workpiece work{*volume_, *binding_};
        if (action.map) {
            const auto grown =
                maps_->buildVoxelGrowth(*action.map, action.thicknessUm, volume_->scale(), progress_);
            if (grown) {
                maps_->takeStatistics(); // of the maps that steer it
                const VoxelGrowthReport what = coatByVoxelGrowth(work, action.material, action.thicknessUm,
                                                                 grown->lattice, grown->growth, progress_);
                report.operation = what.operation;
                report.growths = {what.statistics};
                return;
            }
        }
        const ThicknessMapPtr map = mapOf(action.map);
        report.operation = coat(work, action.material, action.thicknessUm, map.get(), progress_);
        report.growths = maps_->takeStatistics();
        for (GrowthStatistics& growth : report.growths)
            growth.levelUm = growth.levelFactor * action.thicknessUm;
    }

    void perform(const Erode& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        LayerHardness hardness;
        if (action.byHardness)
            for (const std::string& layer : volume_->layers())
                hardness.push_back(materials_.at(layer).hardness);
        Workpiece work{*volume_, *binding_};
        std::optional<double> metalHardness;
        if (action.andMetal)
            metalHardness = action.byHardness ? materials_.at(volume_->metal()).hardness : 1.0;
        report.operation = erode(work, action.thicknessUm, map.get(), hardness, progress_, metalHardness);
        report.growths = maps_->takeStatistics();
    }

    void perform(const Grow& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        Workpiece work{*volume_, *binding_};
        report.operation = growLayer(work, action.material, action.thicknessUm, map.get(), progress_, action.everywhere);
        report.growths = maps_->takeStatistics();
    }

    void perform(const Convert& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        Workpiece work{*volume_, *binding_};
        report.operation = convertLayers(work, action.from, action.to, action.fraction, map.get(), progress_);
        report.growths = maps_->takeStatistics();
    }

    void perform(const Fill& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        Workpiece work{*volume_, *binding_};
        std::optional<double> smoothRadius;
        if (action.aboveSmoothRadiusUm)
            smoothRadius = sceneUnits(*action.aboveSmoothRadiusUm);
        report.operation = fill(work, action.material, action.heightUm, map.get(), progress_, smoothRadius);
        report.growths = maps_->takeStatistics();
    }

    void perform(const Polish& action, StatementReport& report) {
        const ThicknessMapPtr map = mapOf(action.map);
        Workpiece work{*volume_, *binding_};
        if (action.area) {
            AreaPolish what;
            what.fraction = *action.area;
            what.map = map.get();
            if (action.windowUm)
                what.window = sceneUnits(*action.windowUm);
            what.ofMaterial = action.ofMaterial;
            report.operation = polishArea(work, what, progress_);
        } else {
            report.operation = polish(work, action.heightUm.value(), map.get(), progress_);
        }
        report.growths = maps_->takeStatistics();
    }

    void perform(const Offset& action, StatementReport& report) {
        Workpiece work{*volume_, *binding_};
        const double radius = sceneUnits(action.radiusUm);
        report.operation = action.tangentSphereThicknessUm
                               ? offsetTangentSphere(work, action.material, radius, *action.tangentSphereThicknessUm,
                                                     action.global, progress_)
                               : offset(work, action.material, radius, action.global, progress_);
    }

    // A length of the model, which the exaggeration does not scale.
    double sceneUnits(double realUm) const { return realUm * 1e-6 / volume_->scale().metresPerUnit; }

    // `render maps` says that maps are wanted; they are baked from the finished volume.
    void perform(const Render&, StatementReport&) {}

    ThicknessMapPtr mapOf(const std::optional<Expression>& expression) {
        if (!expression)
            return nullptr;
        // Maps know the model's coordinates, operators those of the volume.
        ThicknessMapPtr map = maps_->build(*expression, progress_);
        if (!options_.region)
            return map;
        const Region& region = options_.region->region();
        return makeShiftedMap(std::move(map), 1.0 / region.magnification, region.origin());
    }

    // What voxels are bound to: of a region the piece around it, of which `surface_` is the part in the box.
    const SurfaceMesh& workSurface() const { return options_.region ? options_.region->work() : surface_; }

    void adopt(LayerVolume volume) {
        volume_ = std::make_unique<LayerVolume>(std::move(volume));
        bind(closeSurface(workSurface(), sheetBackVoxels * volume_->scale().voxelSize));
    }

    void bind(const ClosedSurface& closed) {
        binding_ = std::make_unique<SurfaceBinding>(*volume_, workSurface(), closed);
        MapContext context;
        context.volume = volume_.get();
        context.binding = binding_.get();
        const double magnification = options_.region ? options_.region->region().magnification : 1.0;
        context.unitsPerRealUm = 1e-6 / volume_->scale().metresPerUnit / magnification;
        context.voxelSize = volume_->scale().voxelSize / magnification;
        context.longestSide = options_.longestSide;
        context.up = options_.up;
        context.seed = options_.seed;
        context.region = options_.region;
        context.context = options_.context;
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
    std::optional<LayerStatistics> stack_; ///< of the volume as it is
};

// The growth of a coat's map that coatByVoxelGrowth() would take: the first of a product's factors.
const GrowthCall* growthOf(const Expression& map) {
    if (map.kind == Expression::Kind::growth)
        return map.growth.get();
    if (map.kind != Expression::Kind::binary || map.text != "*")
        return nullptr;
    const GrowthCall* first = growthOf(map.children[0]);
    return first ? first : growthOf(map.children[1]);
}

// The highest a coat can make the stack rise: porous layers stand higher than they are thick.
double highestCoatVoxels(const Coat& coat, const VolumeScale& scale) {
    const double thickness = coat.thicknessUm * scale.voxelsPerUm();
    const GrowthCall* call = coat.map ? growthOf(*coat.map) : nullptr;
    if (!call)
        return thickness;
    const GrowthOptions options = historyOf(*call);
    std::optional<double> cellVoxels;
    if (call->cellUm)
        cellVoxels = *call->cellUm * scale.voxelsPerUm() / scale.exaggeration;
    if (!growsInVoxels(scale, coat.thicknessUm, options, cellVoxels))
        return thickness;
    return highestVoxelGrowth(options, call->since, thickness, cellVoxels);
}

} // namespace

double thickestStackVoxels(const Program& program, const VolumeScale& scale) {
    // The highest the stack can stand after each statement; polishing and eroding are not counted on.
    const double perUm = scale.voxelsPerUm(), perRealUm = perUm / scale.exaggeration;
    // What a ball of radius r cannot reach is nearer than r to the metal. Large balls mostly leave less, and the
    // operators make the band grow where they do not.
    constexpr double mostForBalls = 8.0;
    const auto ball = [&](double radiusUm) { return std::min(mostForBalls, radiusUm * perRealUm); };
    double highest = 0.0;
    for (const Statement& statement : program.statements) {
        if (const auto* coat = std::get_if<Coat>(&statement.action)) {
            highest += highestCoatVoxels(*coat, scale);
        } else if (const auto* grow = std::get_if<Grow>(&statement.action)) {
            highest += grow->thicknessUm * perUm;
        } else if (const auto* fill = std::get_if<Fill>(&statement.action)) {
            highest = std::max(highest, fill->heightUm * perUm + ball(fill->aboveSmoothRadiusUm.value_or(0.0)));
        } else if (const auto* offset = std::get_if<Offset>(&statement.action)) {
            highest += offset->tangentSphereThicknessUm ? *offset->tangentSphereThicknessUm * perUm
                                                        : ball(offset->radiusUm);
        }
    }
    return highest;
}

double bandOutsideVoxels(const Program& program, const VolumeScale& scale) {
    // The stack is read as the largest difference of phi, in which a steep map's slopes count for a percent or two.
    return std::max(4.0, std::ceil(1.02 * thickestStackVoxels(program, scale)) + 3.0);
}

double deepestPitVoxels(const Program& program, const VolumeScale& scale) {
    double totalUm = 0.0;
    for (const Statement& statement : program.statements)
        if (const auto* erode = std::get_if<Erode>(&statement.action); erode && erode->andMetal)
            totalUm += erode->thicknessUm;
    return totalUm * scale.voxelsPerUm();
}

void declareAbilities(CheckContext& context, const MaterialLibrary& materials) {
    for (const std::string& name : materials.names())
        context.materials.push_back({name, materials.at(name).isMetal});
    context.operators = {"new", "open", "coat", "erode", "grow", "convert", "fill", "polish", "offset", "render"};
    context.functions = {"texture",  "vertices",      "noise",  "turbulence", "slope", "elevation", "facing",
                         "min",      "max",           "clamp",  "mix",        "pow",   "smoothstep",
                         "exposure", "accessibility", "wetness", "iso9224", "expansion"};
    context.clauses = {"by", "and", "above", "window", "of", "tangent-sphere", "global", "everywhere"};
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
