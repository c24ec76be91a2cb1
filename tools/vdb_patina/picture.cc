#include "picture.h"

#include "table_pose.h"
#include "view_input.h"

#include "base/errors.h"
#include "render/displace.h"
#include "render/exr_picture.h"
#include "render/film.h"
#include "render/path_tracer.h"
#include "render/stack_shader.h"
#include "volume/interface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina::tool {

namespace {

// A picture's light takes 12 bytes a pixel, its features 44, their halves as much again.
constexpr double bytesPerPixel = 160.0;

// The surface that a picture shows, and which point of the model's surface carries the stack that is seen there.
class ShownSurface {
  public:
    ShownSurface(const LayerVolume& volume, const Model& model, const StackShader& shader, const Options& options)
        : model_(model) {
        if (options.from == "volume") {
            surface_ = interfaceMesh(volume, volume.layerCount());
            unturned_ = surface_.positions;
            base_.emplace(model.surface.positions, model.surface.triangles);
        } else {
            surface_ = displaced(model.surface, shader.vertexHeights());
        }
        if (model.region) {
            turn_ = poseOnTable(surface_, options.up);
            turn_.apply(surface_);
            surface_.closed = false; // its sides are cuts, not the inside of a body
        }
    }

    const SurfaceMesh& surface() const { return surface_; }
    Imath::V3f fromModel(const Imath::V3d& point) const { return turn_(Imath::V3f(model_.toLocal(point))); }
    SurfacePoint onModel(const SurfacePoint& point) const {
        if (!base_)
            return point;
        const Imath::V3i& corners = surface_.triangles[std::size_t(point.triangle)];
        const Imath::V3f& a = unturned_[std::size_t(corners[0])];
        const Imath::V3f p =
            a + (unturned_[std::size_t(corners[1])] - a) * point.u + (unturned_[std::size_t(corners[2])] - a) * point.v;
        return base_->closest(p)->point;
    }

  private:
    const Model& model_;
    SurfaceMesh surface_;
    std::vector<Imath::V3f> unturned_;
    std::optional<RayScene> base_;
    Turn turn_;
};

void checkSize(const View& view, const Options& options) {
    const double need = bytesPerPixel * view.width * view.height / (1024.0 * 1024.0 * 1024.0);
    const double allowed = options.budgetGiB > 0.0 ? options.budgetGiB : 4.0;
    if (need > allowed)
        throw Error(ExitCode::budget, "--picture",
                    fmt::format("a picture of {} × {} pixels takes {:.1f} GiB, more than the {:g} allowed", view.width,
                                view.height, need, allowed),
                    "make it smaller");
}

// A close-up shows grain only where the voxels are as fine as its pixels.
void sayWhereVoxelsAreCoarse(const LayerVolume& volume, const View& view, const Options& options, Console& console) {
    if (!view.patch)
        return;
    const int pixels = std::min(view.width, view.height);
    const double across = volume.scale().voxelSize / (*view.patch / pixels);
    if (across < 2.0)
        return;
    const LayerVolume::Provenance& made = volume.provenance;
    console.notice(fmt::format("the volume's voxels are {:.2g} pixels wide in this close-up; for finer grain, run {} on "
                               "{} again with --region-at {} --voxels {} and render that",
                               across, made.scriptName.empty() ? "the script" : "'" + made.scriptName + "'",
                               made.model.empty() ? "the model" : "'" + made.model + "'", options.closeUp, pixels));
}

} // namespace

void exposePicture(const RenderScene& scene, const View& view, const FeaturesAt& featuresAt, const Options& options,
                   const std::filesystem::path& file, const std::string& description, Console& console) {
    checkSize(view, options);
    RenderOptions settings;
    settings.width = view.width;
    settings.height = view.height;
    settings.samples = options.samples;
    settings.seconds = options.seconds;
    const Lights lights =
        lightsOf(options, view.from.azimuthDegrees, scene.setting ? *scene.setting : scene.surface->bounds());
    const Rendering rendering = render(scene, view.camera, lights, settings, console);
    if (options.seconds > 0.0)
        console.info(fmt::format("{} samples per pixel", rendering.samples));

    const ImageMetadata metadata{{"Software", "vdb-patina " PATINA_VERSION}, {"Description", description}};
    if (options.exr) {
        const Features features = renderFeatures(scene, featuresAt, view.camera, view.width, view.height,
                                                 std::min(16, rendering.samples), 0, console);
        std::filesystem::path exr = file;
        writeExrPicture(rendering.image, &features, exr.replace_extension(".exr"), metadata);
    }
    ViewOptions display;
    display.transform = options.viewTransform == "srgb" ? ViewTransform::srgb : ViewTransform::filmic;
    display.exposureStops = float(options.exposureStops);
    writePng(displayImage(rendering.image, display), file, metadata);
}

void writePicture(const LayerVolume& volume, const Model& model, const StackOptics& optics, const Options& options,
                  const std::filesystem::path& file, Console& console) {
    const ProgressStage stage(console, "render " + file.filename().string());
    const StackOptics shown = optics.in(ColourSpace::rec709); // whatever space the maps are in
    const StackShader shader(volume, model.surface, shown);
    const ShownSurface surface(volume, model, shader, options);

    Subject subject;
    subject.surface = &surface.surface();
    subject.fromModel = [&](const Imath::V3d& point) { return surface.fromModel(point); };
    subject.unitsPerModelUnit = model.magnification();
    subject.metresPerModelUnit = volume.scale().metresPerUnit * model.magnification();
    const View view = options.view ? *options.view : viewOf(options, subject);
    if (!options.view)
        sayWhereVoxelsAreCoarse(volume, view, options, console);

    RenderScene scene;
    scene.surface = &surface.surface();
    scene.up = options.up;
    scene.setting = view.setting;
    scene.ground = options.floor && !model.region;
    scene.turntable = options.light == "studio";
    if (model.region && options.light == "studio")
        scene.background = Imath::V3f(0.18f);
    scene.material = [&](const SurfacePoint& point, const Imath::V3f&) { return shader.bsdf(surface.onModel(point)); };
    exposePicture(
        scene, view, [&](const SurfacePoint& point) { return shader.features(surface.onModel(point)); }, options, file,
        volume.provenance.scriptName, console);
}

} // namespace patina::tool
