#include "picture.h"

#include "picture_budget.h"
#include "picture_dice.h"
#include "table_pose.h"
#include "view_input.h"

#include "base/errors.h"
#include "render/dice.h"
#include "render/displace.h"
#include "render/exr_picture.h"
#include "render/film.h"
#include "render/path_tracer.h"
#include "render/stack_shader.h"
#include "render/voxel_surface.h"
#include "volume/interface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

namespace patina::tool {

namespace {

// The model moved out to where the air begins, as coarse as it is: what the camera is placed by.
SurfaceMesh sketchOf(const LayerVolume& volume, const Model& model, const StackOptics& optics) {
    const StackShader shader(volume, model.surface, optics, StackReading::points); // heights only
    return displaced(model.surface, shader.vertexHeights());
}

// The surface that a picture shows, and the points of the model's surface that carry the stack seen there: one for
// each vertex.
struct ShownSurface {
    SurfaceMesh shown;
    SurfaceMesh underVoxels;           ///< from the volume
    std::shared_ptr<DicedModel> diced; ///< from the mesh
    StackReading reading = StackReading::adaptive;

    // The model in triangles of about a pixel, to be displaced by the stack under each vertex. Of a series the last
    // picture's are taken where they would be the same.
    void takeMesh(const Model& model, const View& view, const Turn& turn, float highest, const LayerVolume& volume,
                  const Options& options) {
        DiceOptions dice = dicingOf(view, options, volume.scale().voxelSize);
        dice.toPicture = turn;
        // In steps, so that a patina that grows a little changes nothing.
        while (dice.margin < highest)
            dice.margin *= 2.f;
        const bool dices = options.dice > 0.0 && volume.layerCount() > 0;
        if (!dices)
            dice.longestEdge = std::numeric_limits<float>::infinity();
        const std::shared_ptr<DicedModel> kept = view.diced;
        if (kept && kept->model == &model.surface && kept->margin == dice.margin &&
            kept->longestEdge == dice.longestEdge) {
            diced = kept;
            return;
        }
        diced = kept ? kept : std::make_shared<DicedModel>();
        diced->model = &model.surface;
        diced->margin = dice.margin;
        diced->longestEdge = dice.longestEdge;
        diced->displacer.reset();
        diced->surface = dices ? patina::diced(model.surface, view.camera, dice) : model.surface;
        diced->displacer = std::make_unique<const Displacer>(diced->surface);
    }

    // The voxels' own surface, cut into triangles of about a pixel as the mesh is.
    void takeVolume(const LayerVolume& volume, const Model& model, const View& view, const Turn& turn,
                    const Options& options) {
        reading = StackReading::vertices;
        DiceOptions dice = dicingOf(view, options, volume.scale().voxelSize);
        dice.longestEdge = std::numeric_limits<float>::infinity(); // the interface's own are a voxel long
        dice.toPicture = turn;
        VoxelSurface voxels =
            options.dice > 0.0
                ? voxelSurface(volume, model.surface,
                               [&](const SurfaceMesh& coarse) { return patina::diced(coarse, view.camera, dice); })
                : voxelSurface(volume, model.surface);
        shown = std::move(voxels.shown);
        underVoxels = std::move(voxels.under);
    }

    const SurfaceMesh& base() const { return diced ? diced->surface : underVoxels; }
};

void checkSize(int width, int height, const Options& options) {
    const double need = bytesPerPixel(options.exr) * width * height / (1024.0 * 1024.0 * 1024.0);
    const double allowed = options.budgetGiB > 0.0 ? options.budgetGiB : 4.0;
    if (need > allowed)
        throw Error(ExitCode::budget, "--picture",
                    fmt::format("a picture of {} × {} pixels takes {:.1f} GiB, more than the {:g} allowed", width,
                                height, need, allowed),
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
    console.notice(
        fmt::format("the volume's voxels are {:.2g} pixels wide in this close-up; for finer grain, run {} on "
                    "{} again with --region-at {} --voxels {} and render that",
                    across, made.scriptName.empty() ? "the script" : "'" + made.scriptName + "'",
                    made.model.empty() ? "the model" : "'" + made.model + "'", options.closeUp, pixels));
}

} // namespace

void checkPictureSize(const Options& options) {
    const double aspect = options.aspect > 0.0 ? options.aspect : !options.closeUp.empty() ? 1.0 : widestAspect;
    checkSize(options.pictureSize, int(options.pictureSize * std::min(aspect, 1.0 / aspect)), options);
}

void exposePicture(const RenderScene& scene, const View& view, const FeaturesAt& featuresAt, const Options& options,
                   const std::filesystem::path& file, const std::string& description, Console& console) {
    checkSize(view.width, view.height, options);
    RenderOptions settings;
    settings.width = view.width;
    settings.height = view.height;
    settings.samples = options.samples;
    settings.seconds = options.seconds;
    settings.noise = float(options.noise);
    settings.indirectClamp = float(options.clamp);
    const Lights lights =
        lightsOf(options, view.from.azimuthDegrees, scene.setting ? *scene.setting : scene.surface->bounds());
    const Rendering rendering = render(scene, view.camera, lights, settings, console);
    console.info(fmt::format("{} rays traced in {:.2f} s ({:.2f} s of the processors), {:.3g} samples per pixel",
                             rendering.rays, rendering.seconds, rendering.processorSeconds, rendering.samplesPerPixel));

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
    const auto begin = std::chrono::steady_clock::now();
    const StackOptics colours = optics.in(ColourSpace::rec709); // whatever space the maps are in
    ShownSurface surface;
    const bool ofVolume = options.from == "volume";
    // Whatever is shown: the same camera for mesh and volume.
    SurfaceMesh sketch = sketchOf(volume, model, colours);
    float highest = 0.f; // above the base
    for (std::size_t v = 0; v < sketch.positions.size(); ++v)
        highest = std::max(highest, (sketch.positions[v] - model.surface.positions[v]).length());
    Turn turn;
    if (model.region) {
        turn = poseOnTable(sketch, options.up);
        turn.apply(sketch);
        sketch.closed = false; // its sides are cuts, not the inside of a body
    }

    Subject subject;
    subject.surface = &sketch;
    subject.fromModel = [&](const Imath::V3d& point) { return turn(Imath::V3f(model.toLocal(point))); };
    subject.unitsPerModelUnit = model.magnification();
    subject.metresPerModelUnit = volume.scale().metresPerUnit * model.magnification();
    const View view = options.view ? *options.view : viewOf(options, subject);
    if (!options.view)
        sayWhereVoxelsAreCoarse(volume, view, options, console);
    checkSize(view.width, view.height, options);
    if (isInsideVolume(volume, turn.back(view.camera.position())))
        throw RunError("camera", "it stands inside the object",
                       "move it away: a larger distance, or another direction");
    if (ofVolume)
        surface.takeVolume(volume, model, view, turn, options);
    else
        surface.takeMesh(model, view, turn, highest, volume, options);
    const StackShader shader(volume, surface.base(), colours, surface.reading);
    if (!ofVolume)
        surface.shown = surface.diced->displacer->displaced(shader.vertexHeights());
    turn.apply(surface.shown);
    surface.shown.closed = sketch.closed && (!ofVolume || surface.shown.closed);

    RenderScene scene;
    scene.surface = &surface.shown;
    scene.up = options.up;
    scene.setting = view.setting;
    scene.ground = options.floor && !model.region;
    scene.turntable = takesTurntable(options, view.setting ? *view.setting : surface.shown.bounds());
    if (model.region && options.light == "studio")
        scene.background = Imath::V3f(0.18f);
    scene.material = [&](const SurfacePoint& point, const Imath::V3f&) { return shader.bsdf(point); };
    scene.materials = [&](const HitBatch& hits, const std::vector<int>& from, std::size_t count, BsdfBatch& into) {
        shader.bsdfs(hits, from, count, into);
    };
    console.info(fmt::format("{} triangles set up in {:.2f} s", scene.surface->triangles.size(),
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()));
    exposePicture(
        scene, view, [&](const SurfacePoint& point) { return shader.features(point); }, options, file,
        volume.provenance.scriptName, console);
}

} // namespace patina::tool
