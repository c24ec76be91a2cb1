#include "time_lapse.h"

#include "data_folder.h"
#include "existing_volume.h"
#include "film_file.h"
#include "picture.h"

#include "render/displace.h"
#include "render/stack_blend.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

#include <array>
#include <optional>

namespace patina::tool {

namespace {

namespace fs = std::filesystem;

constexpr float presentUm = 1e-3f; // a nanometre, as the material grid counts it

StackOptics opticsOf(const StackBlend& blend, const std::string& metal, const MaterialLibrary& materials,
                     const Options& options) {
    std::vector<const Material*> stack{&materials.at(metal)};
    for (const std::string& layer : blend.layers())
        stack.push_back(&materials.at(layer));
    StackFeatures features;
    features.thinFilm = options.thinFilm;
    return StackOptics(stack, options.optics == "paper" ? OpticsModel::paper : OpticsModel::energyConserving, features);
}

void writeBlend(const StackBlend& blend, float share, const StackOptics& optics, const Model& model,
                const Options& options, const fs::path& file, const std::string& description, Console& console) {
    const ProgressStage stage(console, "render " + file.filename().string());
    const SurfaceMesh surface = displaced(model.surface, blend.vertexHeights(share));
    // Called for every path: the lobes' storage is kept from one call to the next.
    const auto look = [&](const SurfacePoint& point, float* thicknessUm) -> const Appearance& {
        static thread_local Appearance appearance;
        blend.thickness(point, share, thicknessUm);
        optics.evaluate(thicknessUm, appearance);
        return appearance;
    };
    RenderScene scene;
    scene.surface = &surface;
    scene.up = options.up;
    scene.setting = options.view->setting;
    scene.ground = options.floor;
    scene.turntable = takesTurntable(options, model.surface.bounds());
    scene.material = [&](const SurfacePoint& point, const Imath::V3f&) {
        std::array<float, StackOptics::maxLayers> thicknessUm;
        return PatinaBsdf(look(point, thicknessUm.data()));
    };
    const auto featuresAt = [&](const SurfacePoint& point) {
        std::array<float, StackOptics::maxLayers> thicknessUm;
        PointFeatures features;
        features.albedo = look(point, thicknessUm.data()).baseColour;
        for (std::size_t k = 0; k < blend.layers().size(); ++k) {
            features.thicknessUm += thicknessUm[k];
            if (thicknessUm[k] > presentUm)
                features.material = int(k) + 1;
        }
        return features;
    };
    exposePicture(scene, *options.view, featuresAt, options, file, description, console);
}

} // namespace

int numberOfFrame(std::size_t frame, int between) {
    return int(frame) * (between + 1) + 1;
}

fs::path pictureNumbered(const fs::path& folder, const std::string& name, int number) {
    return folder / fmt::format("{}_{:04}.png", name, number);
}

void writeTimeLapse(const TimeLapse& lapse, const Options& options, const fs::path& folder, Console& console) {
    if (lapse.between > 0 && lapse.volumes.size() > 1) {
        ExistingVolume before = loadExisting(lapse.volumes.front().string(), lapse.model, options, console);
        for (std::size_t i = 0; i + 1 < lapse.volumes.size(); ++i) {
            LayerVolume after = readVolume(lapse.volumes[i + 1]);
            {
                const StackBlend blend(before.volume, after, before.model.surface);
                const StackOptics optics = opticsOf(blend, after.metal(), before.materials, options);
                for (int step = 1; step <= lapse.between; ++step)
                    writeBlend(blend, float(step) / float(lapse.between + 1), optics, before.model, options,
                               pictureNumbered(folder, lapse.name, numberOfFrame(i, lapse.between) + step),
                               after.provenance.scriptName, console);
            }
            before.volume = std::move(after);
        }
    }
    const int count = numberOfFrame(lapse.volumes.size() - 1, lapse.between);
    if (count < 2) {
        console.notice("one picture makes no film");
        return;
    }
    FilmFile film;
    film.pictures = (folder / (lapse.name + "_%04d.png")).string();
    film.count = count;
    film.framesPerSecond = lapse.framesPerSecond;
    const fs::path file = folder / (lapse.name + ".mp4");
    const ProgressStage stage(console, "film");
    switch (encodeFilm(film, file)) {
    case FilmResult::done:
        console.result(file.string());
        break;
    case FilmResult::noProgram:
        console.notice(fmt::format("ffmpeg is not installed: {} pictures, no film; where it is, this makes it: {}",
                                   count, filmCommand(film, file)));
        break;
    case FilmResult::failed:
        console.warning(fmt::format("ffmpeg could not make {}; the pictures are there: {}", file.string(),
                                    filmCommand(film, file)));
    }
}

} // namespace patina::tool
