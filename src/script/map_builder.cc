#include "script/map_builder.h"

#include "operators/growth/grow.h"
#include "operators/growth/growth_map.h"
#include "operators/maps/combined_map.h"
#include "operators/maps/geometry_map.h"
#include "operators/maps/noise_map.h"
#include "operators/maps/texture_map.h"
#include "operators/maps/vertex_map.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// INTERFACE: the default particle is 1/512 of the whole model's longest side.
constexpr double cellsPerLongestSide = 512.0;

double applyBinary(const std::string& op, double a, double b) {
    if (op == "+")
        return a + b;
    if (op == "-")
        return a - b;
    if (op == "*")
        return a * b;
    return a / b;
}

using Function = std::function<double(const double*)>;

Function scalarFunction(const std::string& name, std::size_t count) {
    if (name == "min")
        return [count](const double* v) { return *std::min_element(v, v + count); };
    if (name == "max")
        return [count](const double* v) { return *std::max_element(v, v + count); };
    if (name == "clamp") {
        if (count == 1)
            return [](const double* v) { return std::clamp(v[0], 0.0, 1.0); };
        return [](const double* v) { return std::min(std::max(v[0], v[1]), v[2]); };
    }
    if (name == "mix")
        return [](const double* v) { return v[0] + (v[1] - v[0]) * v[2]; };
    if (name == "pow")
        return [](const double* v) { return std::pow(v[0], v[1]); };
    if (name == "smoothstep")
        return [](const double* v) {
            const double t = std::clamp((v[2] - v[0]) / (v[1] - v[0]), 0.0, 1.0);
            return t * t * (3.0 - 2.0 * t);
        };
    return {};
}

} // namespace

std::vector<GrowthStatistics> MapBuilder::takeStatistics() {
    std::vector<GrowthStatistics> taken;
    taken.swap(statistics_);
    return taken;
}

ThicknessMapPtr MapBuilder::build(const Expression& e, Progress& progress) {
    switch (e.kind) {
    case Expression::Kind::number:
        return makeConstantMap(e.number);
    case Expression::Kind::growth:
        return buildGrowth(*e.growth, progress);
    case Expression::Kind::unary:
        return makeCombinedMap({build(e.children[0], progress)}, [](const double* v) { return -v[0]; });
    case Expression::Kind::binary: {
        const std::string op = e.text;
        return makeCombinedMap({build(e.children[0], progress), build(e.children[1], progress)},
                               [op](const double* v) { return applyBinary(op, v[0], v[1]); });
    }
    case Expression::Kind::curve: {
        const auto curve = e.curve;
        return makeCombinedMap({build(e.children[0], progress)},
                               [curve](const double* v) { return curve->value(v[0]); });
    }
    case Expression::Kind::call:
        return buildCall(e, progress);
    case Expression::Kind::name:
    case Expression::Kind::string:
        break;
    }
    return buildField(e);
}

ThicknessMapPtr MapBuilder::buildField(const Expression& e) const {
    if (e.text == "slope")
        return makeSlopeMap(context_.up);
    if (e.text == "elevation") {
        const Imath::Box3f bounds = context_.binding->surface().bounds();
        return makeElevationMap(context_.up, Imath::Box3d(Imath::V3d(bounds.min), Imath::V3d(bounds.max)));
    }
    throw RunError(e.place.text(), fmt::format("the map '{}' is not available here", e.text));
}

ThicknessMapPtr MapBuilder::buildCall(const Expression& e, Progress& progress) {
    const auto number = [&](std::size_t i) { return e.children[i].number; };
    if (e.text == "texture") {
        const std::string channel = e.children.size() < 2                            ? ""
                                    : e.children[1].kind == Expression::Kind::number ? fmt::format("{}", int(number(1)))
                                                                                     : e.children[1].text;
        return makeTextureMap(context_.binding->surface(), e.children[0].text, channel);
    }
    if (e.text == "vertices")
        return makeVertexMap(context_.binding->surface(), e.children[0].text);
    if (e.text == "noise")
        return std::make_shared<NoiseMap>(number(0) * context_.unitsPerRealUm, context_.seed, "noise");
    if (e.text == "turbulence")
        return std::make_shared<TurbulenceMap>(number(0) * context_.unitsPerRealUm, int(number(1)), context_.seed,
                                               "turbulence");
    if (e.text == "facing")
        return makeFacingMap(Imath::V3d(number(0), number(1), number(2)));
    if (const Function function = scalarFunction(e.text, e.children.size())) {
        std::vector<ThicknessMapPtr> maps;
        for (const Expression& child : e.children)
            maps.push_back(build(child, progress));
        return makeCombinedMap(std::move(maps), function);
    }
    throw RunError(e.place.text(), fmt::format("the map '{}' is not available here", e.text));
}

const GrowthLattice& MapBuilder::lattice(double cell) {
    auto& kept = lattices_[cell];
    if (!kept)
        kept = std::make_unique<GrowthLattice>(surfaceLattice(context_.binding->surface(), cell));
    return *kept;
}

std::vector<float> MapBuilder::perCell(const GrowthLattice& lattice, const ThicknessMap& map) const {
    std::vector<float> values(lattice.size());
    const SurfaceMesh& surface = context_.binding->surface();
    tbb::parallel_for(std::size_t(0), values.size(), [&](std::size_t i) {
        const SurfacePoint under = context_.binding->closest(Imath::V3d(lattice.centres[i]));
        if (under.triangle < 0)
            return;
        const MapPoint point{positionAt(surface, under), normalAt(surface, under), under.triangle, under.u, under.v};
        values[i] = static_cast<float>(std::clamp(map.value(point), 0.0, 1.0));
    });
    return values;
}

std::vector<float> MapBuilder::arrivalFrom(const GrowthLattice& lattice, const Imath::V3d& direction) const {
    // A parallel stream lands in proportion to the cosine, and not where the object itself is in the way.
    std::vector<float> values(lattice.size());
    const Imath::V3f towards(direction);
    const float clearance = static_cast<float>(0.5 * lattice.cell);
    tbb::parallel_for(std::size_t(0), values.size(), [&](std::size_t i) {
        const float cosine = lattice.normals[i].dot(towards);
        if (cosine > 0.f && !context_.binding->occluded(lattice.centres[i] + lattice.normals[i] * clearance, towards))
            values[i] = cosine;
    });
    return values;
}

ThicknessMapPtr MapBuilder::buildGrowth(const GrowthCall& call, Progress& progress) {
    const double cell =
        call.cellUm ? *call.cellUm * context_.unitsPerRealUm : context_.longestSide / cellsPerLongestSide;
    const GrowthLattice& cells = lattice(cell);
    progress.checkpoint();

    GrowthOptions options;
    options.model = *growthModelNamed(call.model);
    options.rate = *growthRateNamed(call.rate);
    options.step = call.step;
    options.total = call.total;
    options.ofFull = call.ofFull;
    if (call.reachUm)
        options.reach = std::max(1, static_cast<int>(std::lround(*call.reachUm * context_.unitsPerRealUm / cell)));
    if (call.patchCells)
        options.patch = *call.patchCells;
    if (call.seeding)
        options.seeding = *call.seeding;
    if (call.points)
        options.pointSpacing = pointSpacingFor(*call.points, context_.binding->surface().area(), cell);
    if (call.arrival)
        options.arrival = perCell(cells, *build(*call.arrival, progress));
    if (call.from) {
        const auto from = arrivalFrom(cells, Imath::V3d((*call.from)[0], (*call.from)[1], (*call.from)[2]));
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
    GrowthPattern pattern = grow(cells, options, context_.seed, call.label, &progress);
    statistics_.push_back(pattern.statistics);
    if (call.since > 0) {
        // One history: the earlier step is part of the later one, and no cell has fallen since.
        GrowthOptions earlier = options;
        earlier.step = call.since;
        const GrowthPattern before = grow(cells, earlier, context_.seed, call.label, &progress);
        std::transform(pattern.factor.begin(), pattern.factor.end(), before.factor.begin(), pattern.factor.begin(),
                       [](float now, float then) { return std::max(0.f, now - then); });
    }
    return std::make_shared<GrowthMap>(cells, pattern.factor, context_.voxelSize);
}

} // namespace patina
