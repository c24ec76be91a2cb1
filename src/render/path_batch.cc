#include "render/path_batch.h"

#include "render/path_kernels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patina {

using Imath::V3f;

namespace {

constexpr int mostSamples = 16; // of each pixel at once: a packet of camera rays
constexpr std::size_t mostPaths = std::size_t(PathBatch::size) * PathBatch::size * mostSamples;

// A tent over -1…1 by inverting its distribution.
float tent(float u) {
    return u < 0.5f ? std::sqrt(2.f * u) - 1.f : 1.f - std::sqrt(2.f - 2.f * u);
}

int groupEnd(int first, int last) {
    const int end = first < mostSamples ? std::max(1, 2 * first) : (first / mostSamples + 1) * mostSamples;
    return std::min(end, last);
}

} // namespace

void PathBatch::Wave::resize(std::size_t count) {
    rays.reserve(count);
    path.resize(count);
    throughput.resize(count);
    directionPdf.resize(count);
    aims.resize(count);
    normal.resize(count);
    lightsDone.resize(count);
}

PathBatch::PathBatch(const PathSetting& setting, const Camera& camera, const KeyedRandom& random)
    : setting_(setting), camera_(camera), lensDraw_(1 + setting.options.maxDepth * drawsPerVertex), sampler_(random) {
    wave_.resize(mostPaths);
    next_.resize(mostPaths);
    hits_.resize(mostPaths);
    at_.resize(mostPaths);
    for (VectorLanes* lanes :
         {&light_, &throughput_, &wo_, &wi_, &value_, &numbers_, &direction_, &radiance_, &arriving_})
        lanes->resize(mostPaths);
    for (auto* lanes : {&pdf_, &density_, &distance_, &most_, &weight_, &roulette_})
        lanes->resize(mostPaths);
    from_.resize(mostPaths);
    path_.resize(mostPaths);
    lightsDone_.resize(mostPaths);
    aims_.resize(mostPaths);
    leavingAims_.resize(mostPaths);
    sources_.resize(mostPaths);
}

void PathBatch::addSamples(Image& image, int left, int top, int first, int last, Work& work) {
    pixels_.clear();
    for (int y = top; y < std::min(top + size, image.height); ++y)
        for (int x = left; x < std::min(left + size, image.width); ++x)
            pixels_.emplace_back(x, y);
    sampler_.begin(pixels_);
    const RenderOptions& options = setting_.options;
    const bool mayEndSooner = options.noise > 0.f && options.seconds == 0.0 && first == 0;
    if (mayEndSooner)
        noise_.begin(pixels_);
    rays_ = 0;
    for (int from = first, to; from < last; from = to) {
        to = groupEnd(from, last);
        aim(from, to);
        for (depth_ = 0; wave_.rays.count > 0; ++depth_) {
            rays_ += wave_.rays.count;
            setting_.stage.rays().intersect(wave_.rays, depth_ == 0, hits_);
            arrive();
            next_.rays.count = 0;
            if (lanes_ > 0) {
                lookAtLights();
                goOn();
            }
            std::swap(wave_, next_);
        }
        std::size_t path = 0;
        for (const Imath::V2i& pixel : pixels_) {
            V3f sum = image.rgb(pixel.x, pixel.y);
            for (int s = from; s < to; ++s, ++path)
                if (const V3f light = light_[path]; std::isfinite(light.x + light.y + light.z))
                    sum += light;
            image.setRgb(pixel.x, pixel.y, sum);
        }
        work.samples += pixels_.size() * std::uint64_t(to - from);
        if (mayEndSooner && noise_.after(to, image) < options.noise && to < last) {
            for (const Imath::V2i& pixel : pixels_)
                image.setRgb(pixel.x, pixel.y, image.rgb(pixel.x, pixel.y) * (float(last) / float(to)));
            break;
        }
    }
    work.rays += rays_;
}

void PathBatch::aim(int first, int last) {
    sampler_.take(first, last);
    const std::size_t count = sampler_.paths();
    for (std::size_t i = 0; i < mostPaths; ++i)
        wave_.path[i] = i < count ? int(i) : 0;
    std::vector<float>&x = numbers_.x, &y = numbers_.y;
    sampler_.draw(0, wave_.path, count, x.data(), y.data());
    if (camera_.hasLens())
        sampler_.draw(lensDraw_, wave_.path, count, wi_.x.data(), wi_.y.data());
    const float width = float(setting_.options.width), height = float(setting_.options.height);
    std::size_t i = 0;
    for (const Imath::V2i& pixel : pixels_)
        for (int s = first; s < last; ++s, ++i) {
            x[i] = (float(pixel.x) + 0.5f + tent(x[i])) / width;
            y[i] = (float(pixel.y) + 0.5f + tent(y[i])) / height;
        }
    camera_.rays(x.data(), y.data(), wi_.x.data(), wi_.y.data(), count, cameraRays_);
    wave_.rays.count = 0;
    for (std::size_t path = 0; path < count; ++path) {
        const V3f origin = cameraRays_.origin(path), direction = cameraRays_.direction(path);
        wave_.rays.add(origin, direction, setting_.stage.reach(origin, direction));
        wave_.throughput.set(path, V3f(1.f));
        light_.set(path, V3f(0.f));
    }
}

void PathBatch::arrive() {
    const Stage& stage = setting_.stage;
    const bool lit = !setting_.lights.area().empty(), goesOn = depth_ < setting_.options.maxDepth;
    floor_.clear();
    leaving_.clear();
    std::size_t surfaces = 0;
    for (std::size_t ray = 0; ray < wave_.rays.count; ++ray) {
        if (hits_.triangle[ray] < 0) {
            if (stage.hasFloor() && std::isfinite(wave_.rays.farthest[ray]))
                floor_.push_back(ray);
            else
                leaving_.push_back(ray);
        } else if (depth_ == 0 || !stage.isClosed() ||
                   !((hits_.geometricNormal[ray] ^ wave_.rays.direction[ray]) > 0.f)) {
            from_[surfaces++] = int(ray);
        } // else: the inside of a closed surface, to which only rounding leads
    }
    std::fill(from_.begin() + std::ptrdiff_t(surfaces), from_.begin() + std::ptrdiff_t(BsdfBatch::padded(surfaces)),
              from_.front());
    if (surfaces > 0 && (lit || goesOn)) {
        stage.shade(wave_.rays, hits_, from_, surfaces, at_, wo_);
        for (std::size_t i = 0; i < surfaces && lit; ++i) {
            const auto ray = std::size_t(from_[i]);
            meetAreaLights(ray, (at_.position[i] - wave_.rays.origin[ray]).length());
        }
    }
    lanes_ = goesOn ? surfaces : 0;
    bsdfs_.begin(lanes_ + floor_.size());
    if (lanes_ > 0)
        stage.materials(hits_, from_, lanes_, bsdfs_);
    for (std::size_t i = 0; i < lanes_; ++i) {
        const auto ray = std::size_t(from_[i]);
        path_[i] = wave_.path[ray];
        throughput_.set(i, wave_.throughput[ray]);
        lightsDone_[i] = 0;
    }
    for (const std::size_t ray : floor_)
        arriveAtFloor(ray);
    std::fill(path_.begin() + std::ptrdiff_t(lanes_), path_.begin() + std::ptrdiff_t(BsdfBatch::padded(lanes_)), 0);
    setting_.lights.aim(lanes_, numbersOf(std::as_const(at_.normal)), aims_.data());
    leaveScene();
}

void PathBatch::arriveAtFloor(std::size_t ray) {
    const Stage& stage = setting_.stage;
    const V3f direction = wave_.rays.direction[ray];
    const StagePoint point = stage.floorPoint(wave_.rays.origin[ray], direction);
    if (!setting_.lights.area().empty())
        meetAreaLights(ray, (point.position - wave_.rays.origin[ray]).length());
    V3f throughput = wave_.throughput[ray];
    const float far = stage.backdropShare(point.position);
    if (far > 0.f) {
        add(wave_.path[ray], throughput, stage.backdrop() * far, depth_ > 1);
        throughput *= 1.f - far;
    }
    if (!(far < 1.f) || depth_ >= setting_.options.maxDepth)
        return;
    const std::size_t lane = lanes_++;
    from_[lane] = int(ray);
    path_[lane] = wave_.path[ray];
    throughput_.set(lane, throughput);
    at_.set(lane, point);
    wo_.set(lane, point.shading.toLocal(-direction));
    bsdfs_.set(lane, stage.floorMaterial());
    // Lights are sampled by radiance times cosine, which is all that a perfectly diffuse surface asks for: there, light
    // met by chance would only add noise.
    lightsDone_[lane] = 1;
}

void PathBatch::goOn() {
    const Stage& stage = setting_.stage;
    const int draw = 1 + depth_ * drawsPerVertex;
    // Numbers that come in pairs, of which the second is not always needed.
    sampler_.draw(draw + 5, path_, lanes_, numbers_.z.data(), numbers_.y.data());
    sampler_.draw(draw + 4, path_, lanes_, numbers_.x.data(), numbers_.y.data());
    bsdfs_.sample(numbers_, wi_, value_, pdf_);
    goOnLanes({BsdfBatch::padded(lanes_), at_.frames(), numbersOf(std::as_const(wi_)), numbersOf(std::as_const(value_)),
               pdf_.data(), numbersOf(throughput_), numbersOf(direction_), most_.data(), weight_.data()});
    // Roulette from the third surface on: paths that carry little end, the others make up for them.
    const bool gambles = depth_ >= 2;
    if (gambles)
        sampler_.draw(draw + 6, path_, lanes_, roulette_.data(), numbers_.y.data());
    for (std::size_t i = 0; i < lanes_; ++i) {
        if (!(weight_[i] > 0.f))
            continue;
        V3f throughput = throughput_[i];
        if (gambles) {
            const float survival = std::min(0.95f, most_[i]);
            if (roulette_[i] >= survival)
                continue;
            throughput /= survival;
        }
        const std::size_t to = next_.rays.count;
        const V3f origin = at_.origin[i], direction = direction_[i];
        next_.rays.add(origin, direction, stage.reach(origin, direction));
        next_.path[to] = path_[i];
        next_.throughput.set(to, throughput);
        next_.directionPdf[to] = pdf_[i];
        next_.aims[to] = aims_[i];
        next_.normal.set(to, at_.normal[i]);
        next_.lightsDone[to] = lightsDone_[i];
    }
}

} // namespace patina
