#include "render/pixel_sampler.h"

#include "render/scrambled_sobol.h"

#include <algorithm>

namespace patina {

namespace {

inline Imath::V2f point(std::uint32_t sample, const std::array<std::uint32_t, 4>& seed) {
    Imath::V2f p;
    scrambledSobol(sample, seed[0], seed[1], seed[2], p.x, p.y);
    return p;
}

} // namespace

const std::array<std::uint32_t, 4>& PixelSampler::seedsOf(int draw) {
    while (std::size_t(draw) >= seeds_.size())
        seeds_.push_back(random_->words(std::uint32_t(seeds_.size()), x_, y_, 0));
    return seeds_[std::size_t(draw)];
}

Imath::V2f PixelSampler::next2() {
    return point(sample_, seedsOf(draw_++));
}

Imath::V2f PixelSampler::next2(int part, int parts) {
    return point(sample_ * std::uint32_t(parts) + std::uint32_t(part), seedsOf(draw_++));
}

float PixelSampler::next1() {
    const auto& seed = seedsOf(draw_++);
    const std::uint32_t index = reverseBits(scrambleReversed(reverseBits(sample_), seed[0]));
    return unitOf(reverseBits(scrambleReversed(index, seed[1])));
}

} // namespace patina
