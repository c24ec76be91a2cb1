#include "render/pixel_sampler.h"

#include <algorithm>

namespace patina {

namespace {

inline std::uint32_t reverseBits(std::uint32_t v) {
    v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    v = ((v >> 4) & 0x0F0F0F0Fu) | ((v & 0x0F0F0F0Fu) << 4);
    return __builtin_bswap32(v);
}

// Multiplying by an even number lets each bit flip only bits above it. On reversed bits that is Owen's scrambling: a
// digit is flipped depending on the more significant ones alone. The constants are those of Burley's paper.
inline std::uint32_t scrambleReversed(std::uint32_t v, std::uint32_t seed) {
    v += seed;
    v ^= v * 0x6c50b47cu;
    v ^= v * 0xb82f1e52u;
    v ^= v * 0xc7afe638u;
    v ^= v * 0x8d22f6e6u;
    return v;
}

// Second dimension of the Sobol' sequence, with the first digit as the lowest bit. Its matrix is Pascal's triangle
// modulo 2: digit r is the sum of the index's bits c of which r is a subset, so it is summed one bit of c at a time.
inline std::uint32_t sobolSecondReversed(std::uint32_t index) {
    index ^= (index & 0xAAAAAAAAu) >> 1;
    index ^= (index & 0xCCCCCCCCu) >> 2;
    index ^= (index & 0xF0F0F0F0u) >> 4;
    index ^= (index & 0xFF00FF00u) >> 8;
    index ^= index >> 16;
    return index;
}

inline float unit(std::uint32_t word) {
    return float(std::int32_t(word >> 8)) * (1.f / 16777216.f); // signed: that is what processors convert
}

inline Imath::V2f point(std::uint32_t sample, const std::array<std::uint32_t, 4>& seed) {
    const std::uint32_t index = reverseBits(scrambleReversed(reverseBits(sample), seed[0]));
    // The first dimension is the index with its bits reversed; scrambling wants it reversed once more.
    const std::uint32_t first = reverseBits(scrambleReversed(index, seed[1]));
    const std::uint32_t second = reverseBits(scrambleReversed(sobolSecondReversed(index), seed[2]));
    return {unit(first), unit(second)};
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

void PixelSampler::draw2(int draw, int first, int last, float* u, float* v) {
    const std::array<std::uint32_t, 4> seed = seedsOf(draw);
    for (int i = first; i < last; ++i) {
        const Imath::V2f p = point(std::uint32_t(i), seed);
        u[i - first] = p.x;
        v[i - first] = p.y;
    }
}

float PixelSampler::next1() {
    const auto& seed = seedsOf(draw_++);
    const std::uint32_t index = reverseBits(scrambleReversed(reverseBits(sample_), seed[0]));
    return unit(reverseBits(scrambleReversed(index, seed[1])));
}

} // namespace patina
