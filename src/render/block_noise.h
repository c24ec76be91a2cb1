#pragma once
// How noisy a block of pixels still is, told from its own samples.

#include "render/image.h"

#include <Imath/ImathVec.h>

#include <limits>
#include <vector>

namespace patina {

/// The standard error of pixels' means in steps of an 8-bit file (sRGB-encoded): the samples so far come in two halves,
/// whose means differ by twice what the mean of all is off by, if they are off independently. One pixel's difference
/// says little, so 4 × 4 pixels and their channels are taken together.
class BlockNoise {
  public:
    static constexpr int group = 4;        ///< pixels each way
    static constexpr int leastSamples = 8; ///< fewer say too little

    /// Before the first sample. \param pixels  of the block, in any order
    void begin(const std::vector<Imath::V2i>& pixels);

    /// Of the noisiest group, from the sums of `taken` samples of each pixel in the image, asked for after every round.
    /// Infinite but where taken is a power of two from leastSamples on, and the sums of half as many were seen.
    float after(int taken, const Image& image);

  private:
    std::vector<Imath::V2i> pixels_;
    std::vector<Imath::V3f> half_; ///< sums of the first halfSamples_ samples
    int halfSamples_ = 0;
};

} // namespace patina
