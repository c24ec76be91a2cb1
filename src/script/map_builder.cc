#include "script/map_builder.h"

#include "operators/maps/combined_map.h"
#include "operators/maps/context_map.h"
#include "operators/maps/geometry_map.h"
#include "operators/maps/noise_map.h"
#include "operators/maps/shifted_map.h"
#include "operators/maps/texture_map.h"
#include "operators/maps/vertex_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

namespace {

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
    return buildField(e, progress);
}

FieldStore& MapBuilder::fieldStore() {
    if (!fields_) {
        FieldStore::Scene scene;
        scene.volume = context_.volume;
        scene.binding = context_.binding;
        scene.up = context_.up;
        const SurfaceMesh& whole = context_.region ? context_.region->whole() : context_.binding->surface();
        scene.lowest = std::numeric_limits<double>::max();
        scene.highest = std::numeric_limits<double>::lowest();
        const Imath::V3d up = context_.up.normalized();
        for (const Imath::V3f& p : whole.positions) {
            const Imath::V3d position(p);
            const double height = (context_.region ? context_.region->region().toLocal(position) : position).dot(up);
            scene.lowest = std::min(scene.lowest, height);
            scene.highest = std::max(scene.highest, height);
        }
        if (context_.region)
            scene.whole = &context_.region->wholeScene();
        fields_ = std::make_unique<FieldStore>(scene);
    }
    return *fields_;
}

ThicknessMapPtr MapBuilder::ofField(const std::string& name,
                                    const std::function<ThicknessMapPtr(FieldStore&)>& compute) {
    if (context_.context)
        if (ThicknessMapPtr map = makeContextMap(*context_.context, name))
            return map;
    ThicknessMapPtr map = compute(fieldStore());
    if (!context_.region)
        return map;
    // Fields know the volume's coordinates, and are asked in the model's.
    const Region& region = context_.region->region();
    return makeShiftedMap(std::move(map), region.magnification, region.origin() * -region.magnification);
}

ThicknessMapPtr MapBuilder::buildField(const Expression& e, Progress& progress) {
    if (!(context_.up.length() > 0.0))
        throw RunError(e.place.text(), fmt::format("'{}' asks where up is, and the model has no up axis", e.text),
                       "give it by --up");
    if (e.text == "exposure" || e.text == "wetness") {
        const ExposureRequest request = e.exposure ? *e.exposure : ExposureRequest();
        return ofField(request.fieldName(e.text), [&](FieldStore& fields) {
            return e.text == "exposure" ? fields.exposure(request, progress) : fields.wetness(request, progress);
        });
    }
    if (e.text == "slope")
        return makeSlopeMap(context_.up);
    if (e.text == "elevation") {
        const Imath::Box3f bounds =
            context_.region ? context_.region->whole().bounds() : context_.binding->surface().bounds();
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
        try {
            return makeTextureMap(mapSurface(), e.children[0].text, channel);
        } catch (const RunError& failure) { // such as a file that ends too soon
            throw RunError(e.children[0].place.text(),
                           fmt::format("the texture {}: {}", failure.place(), failure.message()), failure.remedy());
        }
    }
    if (e.text == "vertices")
        return makeVertexMap(mapSurface(), e.children[0].text);
    if (e.text == "accessibility") {
        AccessibilityRequest request;
        const double unitsPerUm =
            context_.unitsPerRealUm * (context_.region ? context_.region->region().magnification : 1.0);
        request.radiusUm = number(0);
        request.radius = number(0) * unitsPerUm;
        request.softUm = number(1);
        request.soft = number(1) * unitsPerUm;
        request.global = number(2) != 0.0;
        return ofField(request.fieldName(),
                       [&](FieldStore& fields) { return fields.accessibility(request, progress); });
    }
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

const SurfaceMesh& MapBuilder::mapSurface() const {
    return cellSurface_ ? *cellSurface_ : context_.binding->surface();
}

} // namespace patina
