#include "operators/fields/field_store.h"

#include "base/errors.h"
#include "base/hash.h"
#include "operators/fields/accessibility.h"
#include "operators/fields/crease_map.h"
#include "operators/fields/field_grid.h"
#include "operators/fields/surface_average.h"
#include "operators/fields/wetness.h"
#include "volume/band.h"
#include "volume/interface_mesh.h"
#include "volume/nest_grids.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {

using Imath::V3d;
using Imath::V3f;

namespace {

/// Below this height of the stack, voxels, fields are those of the metal.
constexpr double thinStack = 0.25;
/// Creases that hold water are those a ball of this part of the model's height cannot enter.
constexpr double creaseRadius = 0.02;

constexpr const char* originKey = "patina_field_origin";
/// To be raised with every change of what fields are: those of older files are then computed again.
constexpr const char* fieldsVersion = "fields 4";

std::string lengthForName(double um) {
    if (um >= 1e6)
        return fmt::format("{:g}m", um * 1e-6);
    if (um >= 1e3)
        return fmt::format("{:g}mm", um * 1e-3);
    return fmt::format("{:g}um", um);
}

std::uint64_t hashOf(const openvdb::FloatGrid& grid) {
    ContentHash hash;
    for (const FloatLeaf* leaf : leavesOf(grid.tree()))
        hash.add(leaf->buffer().data(), FloatLeaf::SIZE * sizeof(float));
    return hash.digest();
}

void requireUp(const V3d& up) {
    if (!(up.length() > 0.0))
        throw RunError("exposure and wetness", "the model has no up axis", "give it by --up");
}

} // namespace

std::string AccessibilityRequest::fieldName() const {
    return "accessibility_" + lengthForName(radiusUm) + (soft > 0.0 ? "_soft" + lengthForName(softUm) : "") +
           (global ? "_global" : "");
}

std::string ExposureRequest::fieldName(const std::string& word) const {
    const SunAndSky usual;
    std::string name = word;
    const auto add = [&](const std::string& part) { name += "_" + part; };
    if (light.sky)
        add(*light.sky == overcastSky  ? "overcast"
            : *light.sky == uniformSky ? "uniform"
            : *light.sky == clearSky   ? "clear"
                                       : fmt::format("sky{}", *light.sky));
    if (!light.sun)
        add("nosun");
    if (light.latitudeDegrees != usual.latitudeDegrees)
        add(fmt::format("latitude{:g}", light.latitudeDegrees));
    if (light.firstMonth != 1 || light.lastMonth != 12)
        add(fmt::format("months{}to{}", light.firstMonth, light.lastMonth));
    if (light.firstHour != 0.0 || light.lastHour != 24.0)
        add(fmt::format("hours{:g}to{:g}", light.firstHour, light.lastHour));
    if (light.clouds != usual.clouds)
        add(fmt::format("clouds{:g}", light.clouds));
    if (north)
        add(fmt::format("north{:g}_{:g}_{:g}", north->x, north->y, north->z));
    if (rays != 256)
        add(fmt::format("rays{}", rays));
    if (ground)
        add("ground");
    return name;
}

std::string AccessibilityRequest::text() const {
    return fmt::format("{:a} {:a} {}", radius, radiusUm, global) + (soft > 0.0 ? fmt::format(" {:a}", soft) : "");
}

std::string ExposureRequest::text() const {
    const Imath::V3d towards = north.value_or(V3d(0.0));
    return fmt::format("{} {} {:a} {} {} {:a} {:a} {:a} {:a} {:a} {:a} {} {}", light.sky.value_or(-1), light.sun,
                       light.latitudeDegrees, light.firstMonth, light.lastMonth, light.firstHour, light.lastHour,
                       light.clouds, towards.x, towards.y, towards.z, rays, ground);
}

const FieldStore::Surface& FieldStore::presentSurface() {
    LayerVolume& volume = *scene_.volume;
    const int layer = stackHeightVoxels(volume) > thinStack ? volume.layerCount() : 0;
    const std::uint64_t hash = hashOf(*volume.grids().nest()[layer]);
    if (!surfaceKnown_ || hash != surface_.hash) {
        surface_.voxels = findSurfaceVoxels(volume, layer);
        surface_.hash = hash;
    }
    surface_.layer = layer;
    surfaceKnown_ = true;
    return surface_;
}

// All that a field depends on but the model, which belongs to its volume.
std::string FieldStore::originOf(const std::string& name, const std::string& request) const {
    if (scene_.whole)
        return {}; // of a close-up the whole model casts shadows, and is not known here well enough
    ContentHash hash;
    hash.add(fieldsVersion);
    hash.add(name);
    hash.add(request);
    hash.add(fmt::format("{:a} {:a} {:a} {:a} {:a} {} {:x}", scene_.up.x, scene_.up.y, scene_.up.z, scene_.lowest,
                         scene_.highest, surface_.layer, surface_.hash));
    return hash.text();
}

const ThicknessMapPtr* FieldStore::find(const std::string& name, const std::string& request, Reading reading) {
    const Surface& surface = presentSurface();
    auto found = kept_.find(name);
    if (found == kept_.end()) {
        const auto& fields = scene_.volume->grids().fields;
        const auto stored = fields.find(name);
        if (stored == fields.end())
            return nullptr;
        const auto origin = stored->second->getMetadata<openvdb::StringMetadata>(originKey);
        if (!origin || origin->value().empty() || origin->value() != originOf(name, request))
            return nullptr;
        found = kept_.emplace(name, Kept{surface.hash, request, mapOf(name, reading)}).first;
    }
    const Kept& kept = found->second;
    return kept.surface == surface.hash && kept.request == request ? &kept.map : nullptr;
}

ThicknessMapPtr FieldStore::keep(const std::string& name, const std::string& request, const std::vector<float>& values,
                                 Reading reading) {
    storeField(*scene_.volume, name, surface_.layer, surface_.voxels, values);
    scene_.volume->grids().fields.at(name)->insertMeta(originKey, openvdb::StringMetadata(originOf(name, request)));
    kept_[name] = {surface_.hash, request, mapOf(name, reading)};
    return kept_[name].map;
}

std::vector<float> FieldStore::accessibilityValues(const AccessibilityRequest& request, Progress& progress) {
    if (!(request.radius > 0.0))
        throw RunError("accessibility", "the radius must be larger than 0");
    const double limit = request.radius / scene_.volume->scale().voxelSize;
    auto values = accessibleRadii(*scene_.volume, surface_.voxels, surface_.layer, limit, request.global, progress);
    for (float& value : values)
        value = static_cast<float>(std::min(1.0, value / limit));
    return surfaceAverage(surface_.voxels, values, 0.5 * request.soft / scene_.volume->scale().voxelSize, progress);
}

std::optional<Obstacles> FieldStore::modelObstacles() const {
    if (scene_.whole)
        return Obstacles::of(*scene_.whole);
    if (surface_.layer == 0 && !scene_.volume->grids().metal)
        return Obstacles{[this](const V3f& o, const V3f& d) { return scene_.binding->occluded(o, d); },
                         [this](const V3f& o, const V3f& d, float far) { return scene_.binding->firstHit(o, d, far); }};
    return std::nullopt;
}

ThicknessMapPtr FieldStore::mapOf(const std::string& name, Reading reading) const {
    ThicknessMapPtr map = makeFieldMap(*scene_.volume, name);
    // Triangles of a layered surface are as small as voxels: none is wide enough to have sides.
    const auto model = reading == Reading::bySides ? modelObstacles() : std::nullopt;
    if (!model)
        return map;
    const double voxelSize = scene_.volume->scale().voxelSize;
    return readBySides(std::move(map), surface_.voxels, openPlaces(surface_.voxels, voxelSize, *model), voxelSize);
}

std::vector<float> FieldStore::gather(const LightDome& dome, const Compass& compass, const DomeGathering& options,
                                      Progress& progress) {
    const double voxelSize = scene_.volume->scale().voxelSize;
    const auto run = [&](const Obstacles& obstacles) {
        return gatherDome(surface_.voxels, voxelSize, dome, compass, obstacles, options, progress);
    };
    if (const auto model = modelObstacles())
        return run(*model);
    const SurfaceMesh mesh = interfaceMesh(*scene_.volume, surface_.layer);
    const RayScene present(mesh.positions, mesh.triangles);
    return run(Obstacles::of(present));
}

std::vector<float> FieldStore::exposureValues(const ExposureRequest& request, Progress& progress) {
    requireUp(scene_.up);
    const std::string text = request.text();
    if (lastExposure_.request == text && lastExposure_.surface == surface_.hash)
        return lastExposure_.values;
    const Compass compass = Compass::from(scene_.up, request.north.value_or(Compass::usualNorth(scene_.up)));
    DomeGathering options;
    options.rays = request.rays;
    options.ground = request.ground;
    options.groundHeight = scene_.lowest;
    lastExposure_.values = gather(makeLightDome(request.light), compass, options, progress);
    lastExposure_.surface = surface_.hash;
    lastExposure_.request = text;
    return lastExposure_.values;
}

ThicknessMapPtr FieldStore::accessibility(const AccessibilityRequest& request, Progress& progress) {
    const std::string name = request.fieldName();
    if (const auto* kept = find(name, request.text()))
        return *kept;
    return keep(name, request.text(), accessibilityValues(request, progress));
}

ThicknessMapPtr FieldStore::exposure(const ExposureRequest& request, Progress& progress) {
    const std::string name = request.fieldName();
    if (const auto* kept = find(name, request.text(), Reading::bySides))
        return *kept;
    return keep(name, request.text(), exposureValues(request, progress), Reading::bySides);
}

ThicknessMapPtr FieldStore::wetness(const ExposureRequest& request, Progress& progress) {
    const std::string name = request.fieldName("wetness");
    if (const auto* kept = find(name, request.text()))
        return *kept;
    requireUp(scene_.up);
    const double voxelSize = scene_.volume->scale().voxelSize;
    const double height = std::max(scene_.highest - scene_.lowest, voxelSize);
    WetnessParts parts;
    parts.exposure = exposureValues(request, progress);
    const Compass compass = Compass::from(scene_.up, request.north.value_or(Compass::usualNorth(scene_.up)));
    DomeGathering rain;
    rain.rays = 128;
    parts.rain = gather(rainDome(), compass, rain, progress);
    AccessibilityRequest crease;
    crease.radius = creaseRadius * height;
    parts.accessibility = accessibilityValues(crease, progress);
    WetnessOptions options;
    options.up = scene_.up.normalized();
    options.lowest = scene_.lowest / voxelSize;
    options.height = height / voxelSize;
    return keep(name, request.text(), patina::wetness(surface_.voxels, parts, options));
}

} // namespace patina
