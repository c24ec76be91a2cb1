#include "render/block_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace patina {

namespace {

// How fast the sRGB-encoded value rises with light (IEC 61966-2-1); what is brighter than white is seen as white.
float encodedSlope(float linear) {
    const float light = std::min(linear, 1.f);
    return light > 0.0031308f ? 1.055f / 2.4f * std::pow(light, 1.f / 2.4f - 1.f) : 12.92f;
}

} // namespace

void BlockNoise::begin(const std::vector<Imath::V2i>& pixels) {
    pixels_ = pixels;
    half_.assign(pixels.size(), Imath::V3f(0.f));
    halfSamples_ = 0;
}

float BlockNoise::after(int taken, const Image& image) {
    if ((taken & (taken - 1)) != 0)
        return std::numeric_limits<float>::infinity();
    struct Sum {
        double squares = 0.0;
        int count = 0;
    };
    std::map<std::pair<int, int>, Sum> groups;
    for (std::size_t p = 0; p < pixels_.size(); ++p) {
        const Imath::V3f sum = image.rgb(pixels_[p].x, pixels_[p].y);
        Sum& of = groups[{pixels_[p].x / group, pixels_[p].y / group}];
        for (int c = 0; c < 3; ++c) {
            const float off = (sum[c] - 2.f * half_[p][c]) / float(taken) * encodedSlope(sum[c] / float(taken));
            of.squares += double(off) * double(off);
        }
        of.count += 3;
        half_[p] = sum;
    }
    const bool known = taken >= leastSamples && taken == 2 * halfSamples_;
    halfSamples_ = taken;
    if (!known)
        return std::numeric_limits<float>::infinity();
    double most = 0.0;
    for (const auto& [place, sum] : groups)
        most = std::max(most, sum.squares / sum.count);
    return float(255.0 * std::sqrt(most));
}

} // namespace patina
