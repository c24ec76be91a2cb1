#include "render/path_tracer.h"

#include "base/errors.h"
#include "render/path_batch.h"
#include "render/stage.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <thread>

namespace patina {

namespace {

constexpr int tileSize = 16;
static_assert(tileSize % PathBatch::size == 0);

void check(const RenderScene& scene, const RenderOptions& options) {
    if (!scene.surface || scene.surface->triangles.empty())
        throw RunError("picture", "there is no surface to render");
    if (scene.surface->normals.size() != scene.surface->positions.size())
        throw RunError("picture", "the surface has no normals");
    if (!scene.material)
        throw RunError("picture", "the surface has no material");
    if (!(scene.groundAlbedo >= 0.f && scene.groundAlbedo <= 1.f))
        throw RunError("picture", "the floor's albedo must be 0 to 1");
    if (options.width < 1 || options.height < 1 || options.width > 32768 || options.height > 32768)
        throw RunError("picture", "its sides must be 1 to 32768 pixels");
    if (options.samples < 1 || options.samples > 1 << 20)
        throw RunError("picture", "the samples per pixel must be 1 to 1048576");
    if (options.maxDepth < 1 || options.maxDepth > 64)
        throw RunError("picture", "the depth of paths must be 1 to 64");
    if (!(options.noise >= 0.f))
        throw RunError("picture", "the noise allowed must be 0 or more");
    if (!(options.indirectClamp >= 0.f))
        throw RunError("picture", "the bound of indirect light must be 0 or more");
}

} // namespace

Rendering render(const RenderScene& scene, const Camera& camera, const Lights& lights, const RenderOptions& options,
                 Progress& progress) {
    check(scene, options);
    const Stage stage(scene, lights);
    if (stage.isInside(camera.position()))
        throw RunError("camera", "it stands inside the object",
                       "move it away: a larger distance, or another direction");
    const KeyedRandom random(options.seed, "picture", "paths");

    Rendering result;
    result.image = Image(options.width, options.height);
    const int across = (options.width + tileSize - 1) / tileSize;
    const int down = (options.height + tileSize - 1) / tileSize;
    std::atomic<std::uint64_t> rays{0}, taken{0};
    const std::thread::id caller = std::this_thread::get_id();
    const PathSetting setting{stage, lights, options};
    const auto takeRound = [&](int first, int last) {
        std::atomic<int> done{0};
        tbb::parallel_for(tbb::blocked_range<int>(0, across * down, 1), [&](const tbb::blocked_range<int>& range) {
            PathBatch block(setting, camera, random);
            for (int tile = range.begin(); tile != range.end(); ++tile) {
                progress.checkpoint();
                const int left = tile % across * tileSize, top = tile / across * tileSize;
                PathBatch::Work work;
                for (int y = top; y < std::min(top + tileSize, options.height); y += PathBatch::size)
                    for (int x = left; x < std::min(left + tileSize, options.width); x += PathBatch::size)
                        block.addSamples(result.image, x, y, first, last, work);
                rays += work.rays;
                taken += work.samples;
                const int finished = ++done;
                // Progress listens to one thread only: the caller's, which works on tiles too.
                if (std::this_thread::get_id() == caller)
                    progress.update((first + double(last - first) * finished / (across * down)) / options.samples);
            }
        });
    };
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const std::clock_t worked = std::clock();
    while (result.samples < options.samples) {
        int next = options.samples;
        if (options.seconds > 0.0) {
            next = std::min(options.samples, std::max(1, 2 * result.samples));
            const double gone = std::chrono::duration<double>(Clock::now() - begin).count();
            if (result.samples > 0 && gone + gone / result.samples * (next - result.samples) > options.seconds)
                break;
        }
        takeRound(result.samples, next);
        result.samples = next;
    }
    for (float& c : result.image.pixels)
        c /= float(result.samples);
    result.rays = rays;
    result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    result.processorSeconds = double(std::clock() - worked) / CLOCKS_PER_SEC;
    result.samplesPerPixel = double(taken) / (double(options.width) * options.height);
    return result;
}

} // namespace patina
