#include "view_input.h"

#include "base/errors.h"
#include "render/image_environment.h"
#include "render/sky_environment.h"
#include "surface/ray_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace patina::tool {

namespace {

constexpr double degrees = 180.0 / M_PI;

// "1,2,3" as numbers; empty where something else stands there.
std::vector<double> numbersIn(std::string text) {
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream in(text);
    std::vector<double> numbers;
    for (double number; in >> number;)
        numbers.push_back(number);
    return in.eof() ? numbers : std::vector<double>{};
}

std::vector<double> numbersOf(const std::string& option, const std::string& text, std::size_t least, std::size_t most,
                              const std::string& form) {
    const std::vector<double> numbers = numbersIn(text);
    if (numbers.size() < least || numbers.size() > most)
        throw Error(ExitCode::commandLine, option, "'" + text + "' is not " + form, "write, for example, " + form);
    return numbers;
}

float aspectOf(const SurfaceMesh& surface, UpAxis up, float elevationDegrees) {
    const Imath::V3f size = surface.bounds().size();
    const float height = up == UpAxis::y ? size.y : size.z;
    const float depth = up == UpAxis::y ? size.z : size.y;
    const float tilt = elevationDegrees / float(degrees);
    const float seenHeight = height * std::cos(tilt) + depth * std::sin(std::abs(tilt));
    return std::clamp(std::max(size.x, 0.5f * depth) / std::max(seenHeight, 1e-6f * size.x), narrowestAspect,
                      widestAspect);
}

struct CloseUp {
    Imath::V3f middle, normal;
    float size;
};

CloseUp closeUpOf(const std::string& text, const Subject& subject) {
    const auto numbers = numbersOf("--closeup", text, 4, 4, "0.01,0.1,0.02,0.005 (x, y, z, size)");
    if (!(numbers[3] > 0.0))
        throw Error(ExitCode::commandLine, "--closeup", "its size must be above 0",
                    "give the side of the patch in scene units");
    const RayScene rays(subject.surface->positions, subject.surface->triangles);
    const Imath::V3f asked = subject.fromModel({numbers[0], numbers[1], numbers[2]});
    const float size = float(numbers[3] * subject.unitsPerModelUnit);
    const auto nearest = rays.closest(asked);
    if (!nearest || nearest->distance > size)
        throw Error(ExitCode::commandLine, "--closeup",
                    fmt::format("no surface lies within {:g} of the point", numbers[3]),
                    nearest ? fmt::format("the nearest is {:.4g} away", nearest->distance / subject.unitsPerModelUnit)
                            : "give a point on the model");
    return {Imath::V3f(positionAt(*subject.surface, nearest->point)),
            Imath::V3f(normalAt(*subject.surface, nearest->point)), size};
}

// Focused on what the middle of the picture shows. A full-frame lens: 24 mm over the picture's shorter side.
void giveLens(Camera& camera, const CameraView& view, const Options& options, const Subject& subject) {
    const RayScene rays(subject.surface->positions, subject.surface->triangles);
    const CameraRay middle = camera.ray(0.5f, 0.5f);
    const auto hit = rays.intersect(middle.origin, middle.direction);
    const float focus = hit ? hit->distance : (subject.surface->bounds().center() - camera.position()).length();
    const double focalMetres = 0.012 / std::tan(0.5 * view.fieldOfViewDegrees / degrees);
    const double radiusMetres = focalMetres / (2.0 * options.fStop);
    camera.setLens(float(radiusMetres / subject.metresPerModelUnit * subject.unitsPerModelUnit), focus);
}

} // namespace

View viewOf(const Options& options, const Subject& subject) {
    const auto set = [&](const char* option, const std::string& text, CameraView& view) -> std::optional<double> {
        if (text.empty())
            return {};
        const auto numbers =
            numbersOf(option, text, 2, 4, "20,15,0.8,22 (azimuth, elevation[, distance[, field of view]])");
        view.azimuthDegrees = float(numbers[0]);
        view.elevationDegrees = float(numbers[1]);
        if (numbers.size() > 3)
            view.fieldOfViewDegrees = float(numbers[3]);
        return numbers.size() > 2 ? std::optional(numbers[2] * subject.unitsPerModelUnit) : std::nullopt;
    };
    View view;
    view.from = automaticView(*subject.surface, options.up);
    std::optional<CloseUp> closeUp;
    if (!options.closeUp.empty()) {
        // A little aside of straight on: relief shows by its shading.
        closeUp = closeUpOf(options.closeUp, subject);
        const Imath::V3f n = uprightFrame(options.up).toLocal(closeUp->normal);
        view.from.elevationDegrees =
            float(std::clamp(std::asin(std::clamp(double(n.z), -1.0, 1.0)) * degrees + 8.0, -70.0, 70.0));
        if (std::hypot(n.x, n.y) > 0.1f)
            view.from.azimuthDegrees = float(std::atan2(n.x, -n.y) * degrees + 15.0);
    }
    const std::optional<double> distance = set("--camera", options.camera, view.from);
    if (options.azimuth)
        view.from.azimuthDegrees = float(*options.azimuth);
    if (options.elevation)
        view.from.elevationDegrees = float(*options.elevation);

    const float aspect = options.aspect > 0.0 ? float(options.aspect)
                         : closeUp            ? 1.f
                                              : aspectOf(*subject.surface, options.up, view.from.elevationDegrees);
    const int size = options.pictureSize;
    view.width = aspect >= 1.f ? size : std::max(1, int(std::lround(size * aspect)));
    view.height = aspect >= 1.f ? std::max(1, int(std::lround(size / aspect))) : size;
    const float ratio = float(view.width) / float(view.height);
    const float half = std::tan(0.5f * view.from.fieldOfViewDegrees / float(degrees));
    if (closeUp)
        view.camera =
            Camera::aimed(closeUp->middle, float(distance.value_or(0.5 * closeUp->size / half)), view.from, ratio);
    else if (distance)
        view.camera = Camera::aimed(subject.surface->bounds().center(), float(*distance), view.from, ratio);
    else
        view.camera = Camera::framed(subject.surface->positions, view.from, ratio);
    if (closeUp)
        view.patch = closeUp->size;
    if (options.fStop > 0.0)
        giveLens(view.camera, view.from, options, subject);
    return view;
}

View stillViewOf(const Options& options, const Model& model) {
    Subject subject;
    subject.surface = &model.surface;
    subject.fromModel = [&](const Imath::V3d& point) { return Imath::V3f(model.toLocal(point)); };
    subject.unitsPerModelUnit = model.magnification();
    subject.metresPerModelUnit = model.scale.metresPerUnit * model.magnification();
    View view = viewOf(options, subject);
    view.setting = model.surface.bounds();
    if (!model.region) // which is turned anew for each picture
        view.diced = std::make_shared<DicedModel>();
    return view;
}

bool takesTurntable(const Options& options, const Imath::Box3f& object) {
    const Imath::V3f size = object.size();
    const float height = options.up == UpAxis::y ? size.y : size.z;
    const float across = std::hypot(size.x, options.up == UpAxis::y ? size.z : size.y);
    return options.light == "studio" && height > 0.25f * across;
}

Lights lightsOf(const Options& options, float cameraAzimuthDegrees, const Imath::Box3f& object) {
    const std::string& light = options.light;
    if (light == "studio")
        return studioSet(options.up, object, cameraAzimuthDegrees + float(options.turnLight));
    if (light == "uniform")
        return Lights(std::make_shared<UniformEnvironment>(Imath::V3f(float(options.lightStrength))), {}, options.up);
    if (light == "sky" || light == "overcast") {
        Daylight day;
        if (light == "overcast") {
            day.sky = 16;
            day.sun = false;
        }
        if (!options.sun.empty()) {
            const auto numbers = numbersOf("--sun", options.sun, 2, 2, "-50,40 (azimuth, altitude)");
            day.sunAzimuthDegrees = float(numbers[0]);
            day.sunAltitudeDegrees = float(numbers[1]);
        }
        day.sunAzimuthDegrees += float(options.turnLight);
        return daylight(day, options.up);
    }
    if (!std::filesystem::exists(light))
        throw Error(ExitCode::commandLine, "--light", "there is no light '" + light + "' and no such file",
                    "give studio, sky, overcast, uniform or the file of a panorama (EXR, HDR)");
    return Lights(std::make_shared<ImageEnvironment>(readPanorama(light), options.up, float(options.turnLight),
                                                     float(options.lightStrength)),
                  {}, options.up);
}

} // namespace patina::tool
