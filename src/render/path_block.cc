#include "render/path_block.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

using Imath::V3f;

namespace {

constexpr int mostSamples = 32; // of each pixel at once
constexpr int packetSize = RayScene::packetSize;

bool isFinite(const V3f& c) {
    return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

// A tent over -1…1 by inverting its distribution.
float tent(float u) {
    return u < 0.5f ? std::sqrt(2.f * u) - 1.f : 1.f - std::sqrt(2.f - 2.f * u);
}

int groupEnd(int first, int last) {
    const int end = first < mostSamples ? std::max(1, 2 * first) : (first / mostSamples + 1) * mostSamples;
    return std::min(end, last);
}

} // namespace

PathBlock::PathBlock(const PathSetting& setting, const Camera& camera, const KeyedRandom& random)
    : setting_(setting), camera_(camera), random_(random),
      lensDraw_(1 + setting.options.maxDepth * PathWalk::drawsPerVertex) {
    packet_.coherent = true;
}

std::uint64_t PathBlock::addSamples(Image& image, int left, int top, int first, int last) {
    pixels_.clear();
    for (int y = top; y < std::min(top + size, image.height); ++y)
        for (int x = left; x < std::min(left + size, image.width); ++x)
            pixels_.push_back({x, y, PixelSampler(random_, x, y), image.rgb(x, y)});
    rays_ = 0;
    for (int from = first, to; from < last; from = to) {
        to = groupEnd(from, last);
        traced_ = packet_.count = 0;
        // Samples of one pixel lie next to each other, and go nearly the same way.
        for (Pixel& pixel : pixels_) {
            aim(pixel, from, to);
            for (int s = 0; s < to - from; ++s) {
                const V3f origin = cameraRays_.origin(std::size_t(s)),
                          direction = cameraRays_.direction(std::size_t(s));
                packet_.set(packet_.count++, origin, direction, setting_.stage.reach(origin, direction));
                if (packet_.count == packetSize)
                    trace(to - from, from);
            }
        }
        if (packet_.count > 0)
            trace(to - from, from);
    }
    for (const Pixel& pixel : pixels_)
        image.setRgb(pixel.x, pixel.y, pixel.sum);
    return rays_;
}

void PathBlock::trace(int samples, int first) {
    std::array<std::optional<RayScene::Hit>, packetSize> hits;
    setting_.stage.rays().intersect(packet_, hits.data());
    for (int i = 0; i < packet_.count; ++i, ++traced_) {
        Pixel& pixel = pixels_[std::size_t(traced_ / samples)];
        pixel.sampler.startSample(std::uint32_t(first + traced_ % samples));
        PathWalk path(setting_, {packet_.originX[i], packet_.originY[i], packet_.originZ[i]},
                      {packet_.directionX[i], packet_.directionY[i], packet_.directionZ[i]}, pixel.sampler);
        if (const V3f light = path.radiance(hits[std::size_t(i)]); isFinite(light))
            pixel.sum += light;
        rays_ += path.rays();
    }
    packet_.count = 0;
}

void PathBlock::aim(Pixel& pixel, int first, int last) {
    const auto count = std::size_t(last - first);
    for (auto* numbers : {&random1_, &random2_, &lens1_, &lens2_})
        numbers->resize(count);
    pixel.sampler.draw2(0, first, last, random1_.data(), random2_.data());
    if (camera_.hasLens())
        pixel.sampler.draw2(lensDraw_, first, last, lens1_.data(), lens2_.data());
    const float width = float(setting_.options.width), height = float(setting_.options.height);
    for (std::size_t i = 0; i < count; ++i) {
        random1_[i] = (float(pixel.x) + 0.5f + tent(random1_[i])) / width;
        random2_[i] = (float(pixel.y) + 0.5f + tent(random2_[i])) / height;
    }
    camera_.rays(random1_.data(), random2_.data(), lens1_.data(), lens2_.data(), count, cameraRays_);
}

} // namespace patina
