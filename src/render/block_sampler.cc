#include "render/block_sampler.h"

#include "render/path_kernels.h"

#include <algorithm>

namespace patina {

void BlockSampler::begin(const std::vector<Imath::V2i>& pixels) {
    pixels_ = pixels;
    std::fill(seedsMade_.begin(), seedsMade_.end(), char(0));
}

void BlockSampler::take(int first, int last) {
    pixelOf_.clear();
    sampleOf_.clear();
    for (std::size_t p = 0; p < pixels_.size(); ++p)
        for (int s = first; s < last; ++s) {
            pixelOf_.push_back(std::int32_t(p));
            sampleOf_.push_back(std::uint32_t(s));
        }
}

void BlockSampler::draw(int draw, const std::vector<int>& path, std::size_t count, float* u, float* v, int part,
                        int parts) {
    const auto number = std::size_t(draw);
    if (number >= seeds_.size()) {
        seeds_.resize(number + 1);
        seedsMade_.resize(number + 1, 0);
    }
    Seeds& seeds = seeds_[number];
    if (!seedsMade_[number]) {
        for (auto* of : {&seeds.first, &seeds.second, &seeds.third})
            of->resize(pixels_.size());
        for (std::size_t p = 0; p < pixels_.size(); ++p) {
            const auto words = random_->words(std::uint32_t(draw), pixels_[p].x, pixels_[p].y, 0);
            seeds.first[p] = words[0];
            seeds.second[p] = words[1];
            seeds.third[p] = words[2];
        }
        seedsMade_[number] = 1;
    }
    const std::uint32_t* samples = sampleOf_.data();
    if (parts > 1) {
        partOf_.resize(sampleOf_.size());
        for (std::size_t i = 0; i < sampleOf_.size(); ++i)
            partOf_[i] = sampleOf_[i] * std::uint32_t(parts) + std::uint32_t(part);
        samples = partOf_.data();
    }
    drawLanes({(count + 15) / 16 * 16, path.data(), pixelOf_.data(), samples, seeds.first.data(), seeds.second.data(),
               seeds.third.data(), u, v});
}

} // namespace patina
