// The growths among a script's maps: lattices, what steers them, and who may be made of voxels.

#include "script/map_builder.h"

#include "operators/growth/growth_map.h"
#include "operators/growth/nest_relief.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace patina {

namespace {

// INTERFACE: the default particle is 1/512 of the whole model's longest side.
constexpr double cellsPerLongestSide = 512.0;
// The voxel of a preview of 256 along the longest side, in such cells.
constexpr double grainCells = 2.0;

} // namespace

GrowthOptions historyOf(const GrowthCall& call) {
    GrowthOptions options;
    options.model = *growthModelNamed(call.model);
    options.rate = *growthRateNamed(call.rate);
    options.step = call.step;
    options.total = call.total;
    options.ofFull = call.ofFull;
    return options;
}

const GrowthLattice& MapBuilder::lattice(double cell, double marginCells) {
    auto& kept = lattices_[{cell, context_.region ? marginCells : 0.0}];
    if (kept)
        return *kept;
    if (!context_.region) {
        kept = std::make_unique<GrowthLattice>(surfaceLattice(context_.binding->surface(), cell));
        return *kept;
    }
    // A few cells more for those who read the pattern at the region's outermost voxels.
    const double margin = (marginCells + 4.0) * cell + 2.0 * context_.voxelSize;
    SurfaceMesh surface = context_.region->growthSurface(margin, 1.5 * std::max(cell, context_.voxelSize));
    kept = std::make_unique<GrowthLattice>(surfaceLattice(surface, cell));
    RayScene scene(surface.positions, surface.triangles);
    pieces_[kept.get()] = std::make_unique<GrowthPiece>(GrowthPiece{std::move(surface), std::move(scene)});
    return *kept;
}

std::vector<float> MapBuilder::perCell(const GrowthLattice& lattice, const ThicknessMap& map) const {
    std::vector<float> values(lattice.size());
    const auto piece = pieces_.find(&lattice);
    const SurfaceMesh& surface = piece != pieces_.end() ? piece->second->surface : context_.binding->surface();
    tbb::parallel_for(std::size_t(0), values.size(), [&](std::size_t i) {
        SurfacePoint under;
        if (piece == pieces_.end())
            under = context_.binding->closest(Imath::V3d(lattice.centres[i]));
        else if (const auto found = piece->second->scene.closest(lattice.centres[i]))
            under = found->point;
        if (under.triangle < 0)
            return;
        const MapPoint point{positionAt(surface, under), normalAt(surface, under), under.triangle, under.u, under.v};
        values[i] = static_cast<float>(std::clamp(map.value(point), 0.0, 1.0));
    });
    return values;
}

std::vector<float> MapBuilder::arrivalFrom(const GrowthLattice& lattice, const Imath::V3d& direction) const {
    // A parallel stream lands in proportion to the cosine, and not where the object itself is in the way, or what lies
    // on it by now.
    std::vector<float> values(lattice.size());
    std::optional<NestShadow> shadow;
    if (context_.volume && context_.volume->layerCount() > 0)
        shadow.emplace(*context_.volume);
    const Imath::V3d origin = context_.region ? context_.region->region().origin() : Imath::V3d(0.0);
    const double magnification = context_.region ? context_.region->region().magnification : 1.0;
    const auto isInNestsShadow = [&](std::size_t i) {
        return shadow && shadow->falls((Imath::V3d(lattice.centres[i]) - origin) * magnification,
                                       Imath::V3d(lattice.normals[i]), direction, 0.5 * lattice.cell * magnification);
    };
    const Imath::V3f towards(direction);
    const float clearance = static_cast<float>(0.5 * lattice.cell);
    const auto isOccluded = [&](const Imath::V3f& start) {
        if (!context_.region)
            return context_.binding->occluded(start, towards);
        const Imath::V3f local(context_.region->region().toLocal(Imath::V3d(start)));
        return context_.region->wholeScene().occluded(local, towards, 0.f, std::numeric_limits<float>::infinity());
    };
    tbb::parallel_for(std::size_t(0), values.size(), [&](std::size_t i) {
        const float cosine = lattice.normals[i].dot(towards);
        if (cosine > 0.f && !isOccluded(lattice.centres[i] + lattice.normals[i] * clearance) && !isInNestsShadow(i))
            values[i] = cosine;
    });
    return values;
}

double MapBuilder::cellOf(const GrowthCall& call, double byDefault) const {
    return call.cellUm ? *call.cellUm * context_.unitsPerRealUm : byDefault;
}

MapBuilder::GrowthSetup MapBuilder::setUpGrowth(const GrowthCall& call, double cell, bool asHeights,
                                                Progress& progress) {
    GrowthOptions options = historyOf(call);
    if (call.reachUm)
        options.reach = std::max(1, static_cast<int>(std::lround(*call.reachUm * context_.unitsPerRealUm / cell)));
    if (call.patchCells)
        options.patch = *call.patchCells;
    if (call.seeding)
        options.seeding = *call.seeding;
    if (call.points)
        options.pointSpacing = pointSpacingFor(
            *call.points, context_.region ? context_.region->whole().area() : context_.binding->surface().area(), cell);
    const bool slanted = call.from && options.model == GrowthModel::ballisticDeposition;
    if (slanted && !asHeights)
        options.from = Imath::V3d((*call.from)[0], (*call.from)[1], (*call.from)[2]);
    const GrowthLattice& cells = lattice(cell, growthMarginCells(options));
    progress.checkpoint();
    const SurfaceMesh* const outer = cellSurface_; // arrival and blocked may grow patterns of their own
    if (const auto piece = pieces_.find(&cells); piece != pieces_.end())
        cellSurface_ = &piece->second->surface;
    if (call.arrival)
        options.arrival = perCell(cells, *build(*call.arrival, progress));
    std::vector<float> flux;
    if (call.from) {
        auto from = arrivalFrom(cells, Imath::V3d((*call.from)[0], (*call.from)[1], (*call.from)[2]));
        if (slanted && asHeights) {
            // Where a height stands for the solid it has to follow the flux, which the height of a younger envelope
            // does not; and in a film much thinner than its cells are wide no track leaves its cell.
            flux = from;
            for (float& lands : from)
                lands = lands > 0.f ? 1.f : 0.f;
        }
        if (options.arrival.empty())
            options.arrival = from;
        else
            std::transform(from.begin(), from.end(), options.arrival.begin(), options.arrival.begin(),
                           [](float a, float b) { return a * b; });
    }
    if (call.blocked) {
        if (call.blocked->kind == Expression::Kind::number)
            options.blockedFraction = call.blocked->number;
        else
            options.blocked = perCell(cells, *build(*call.blocked, progress));
    }
    cellSurface_ = outer;
    return {cells, std::move(options), std::move(flux)};
}

std::shared_ptr<const GrowthPattern> MapBuilder::pattern(const GrowthLattice& cells, const GrowthOptions& options,
                                                         const std::string& label, Progress& progress,
                                                         bool keepsStepBefore) {
    // What maps steer depends on more than its options; and large lattices are not worth their memory.
    constexpr std::size_t mostCells = 4'000'000, mostPatterns = 12;
    if (!options.arrival.empty() || !options.blocked.empty() || cells.size() > mostCells) {
        auto made = std::make_shared<const GrowthPattern>(grow(cells, options, context_.seed, label, &progress));
        followed_ += made->statistics.arrivals;
        return made;
    }
    const std::string history =
        fmt::format("{} {} {:a} {} {} {} {:a} {:a} {:a} {} {}", int(options.model), int(options.rate), options.total,
                    options.ofFull, options.reach, options.patch, options.seeding, options.blockedFraction,
                    options.pointSpacing, static_cast<const void*>(&cells), label);
    const Grown* earlier = nullptr;
    for (const Grown& kept : recent_) {
        if (kept.history != history || kept.step > options.step)
            continue;
        if (kept.step == options.step)
            return kept.pattern;
        if (!earlier || kept.step > earlier->step)
            earlier = &kept;
    }
    // A frame that ends in a step goes on from the one before it (weather_script.cc): that is passed on the way.
    std::shared_ptr<const GrowthPattern> passed;
    if (keepsStepBefore && goesOn(options) && options.step > 1.0 && (!earlier || earlier->step < options.step - 1.0)) {
        GrowthOptions onTheWay = options;
        onTheWay.step = options.step - 1.0;
        passed = pattern(cells, onTheWay, label, progress, false);
        earlier = &recent_.back();
    }
    auto made = std::make_shared<const GrowthPattern>(
        earlier ? growOn(cells, options, context_.seed, label, *earlier->pattern, earlier->step, &progress)
                : grow(cells, options, context_.seed, label, &progress));
    followed_ += made->statistics.arrivals;
    recent_.push_back({history, options.step, made});
    if (recent_.size() > mostPatterns)
        recent_.pop_front();
    return made;
}

ThicknessMapPtr MapBuilder::buildGrowth(const GrowthCall& call, Progress& progress) {
    const double byDefault = context_.longestSide / cellsPerLongestSide;
    const auto [cells, options, flux] = setUpGrowth(call, cellOf(call, byDefault), true, progress);
    followed_ = 0;
    // One history: the earlier step is part of the later one, and no cell has fallen since.
    std::shared_ptr<const GrowthPattern> before;
    if (call.since > 0) {
        GrowthOptions earlier = options;
        earlier.step = call.since;
        before = pattern(cells, earlier, call.label, progress);
    }
    const auto now = pattern(cells, options, call.label, progress);
    statistics_.push_back(now->statistics);
    statistics_.back().arrivals = followed_;
    std::vector<float> factor = now->factor;
    if (before)
        std::transform(factor.begin(), factor.end(), before->factor.begin(), factor.begin(),
                       [](float here, float then) { return std::max(0.f, here - then); });
    if (!flux.empty())
        std::transform(factor.begin(), factor.end(), flux.begin(), factor.begin(), std::multiplies<>());
    // Grains nobody chose are no finer than a preview shows them: it and the final have one look. What the script
    // gave is shown as finely as voxels can.
    const double grain = call.cellUm ? cells.cell : grainCells * cells.cell;
    const double pitch = context_.voxelSize;
    double width = readingWidth(grain, pitch);
    // Between finer voxels the pattern is smoothed less by their interpolation, and as much more by its reader.
    if (!call.cellUm && pitch < grain)
        width = std::max(0.75 * grain, std::sqrt(1.4 * grain * grain - pitch * pitch));
    return std::make_shared<GrowthMap>(cells, factor, width, readingShift(cells.cell, grain, pitch));
}

std::optional<MapBuilder::CoatGrowth> MapBuilder::buildVoxelGrowth(const Expression& expression, double thicknessUm,
                                                                   const VolumeScale& scale, Progress& progress) {
    // Down the left side of a product: its first factor that is a growth, and the others.
    const GrowthCall* call = nullptr;
    std::vector<const Expression*> open{&expression}, others;
    while (!open.empty()) {
        const Expression* e = open.back();
        open.pop_back();
        if (e->kind == Expression::Kind::binary && e->text == "*") {
            open.push_back(&e->children[1]);
            open.push_back(&e->children[0]);
        } else if (e->kind == Expression::Kind::growth && !call) {
            call = e->growth.get();
        } else {
            others.push_back(e);
        }
    }
    if (!call)
        return {};
    // A voxel where the script says nothing (INTERFACE), but of a whole model no finer than on surface cells.
    const double coarse = context_.longestSide / cellsPerLongestSide;
    const bool voxels = context_.region || coarse < 1.01 * context_.voxelSize;
    const double byDefault = voxels ? context_.voxelSize : coarse;
    const bool cubes = !call->cellUm && voxels;
    const double cell = cellOf(*call, byDefault);
    std::optional<double> cellVoxels;
    if (!cubes)
        cellVoxels = cell / context_.voxelSize;
    if (!growsInVoxels(scale, thicknessUm, historyOf(*call), cellVoxels))
        return {};
    auto [cells, options, flux] = setUpGrowth(*call, cell, false, progress);
    VoxelGrowth growth;
    growth.options = std::move(options);
    growth.since = call->since;
    growth.seed = context_.seed;
    growth.label = call->label;
    growth.cubes = cubes;
    if (context_.region) {
        growth.origin = context_.region->region().origin();
        growth.magnification = context_.region->region().magnification;
    }
    const SurfaceMesh* const outer = cellSurface_;
    if (const auto piece = pieces_.find(&cells); piece != pieces_.end())
        cellSurface_ = &piece->second->surface;
    for (const Expression* other : others) {
        const std::vector<float> values = perCell(cells, *build(*other, progress));
        if (growth.factor.empty())
            growth.factor = values;
        else
            std::transform(values.begin(), values.end(), growth.factor.begin(), growth.factor.begin(),
                           [](float a, float b) { return a * b; });
    }
    cellSurface_ = outer;
    return CoatGrowth{cells, std::move(growth)};
}

} // namespace patina
