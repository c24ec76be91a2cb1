#pragma once
// The random numbers of one pixel: padded Sobol' points with Owen scrambling.

#include "base/random.h"

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// Numbers in [0, 1) that fill their square evenly over the samples of a pixel. They are a pure function of the key,
/// the pixel, the sample's index and how many were drawn before, so a picture is the same on any number of threads.
/// Each draw is one two-dimensional Sobol' point, with the order of the samples shuffled and the digits scrambled on
/// its own (Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4)); the seeds come from the keyed generator.
class PixelSampler {
  public:
    PixelSampler(const KeyedRandom& random, int x, int y) : random_(&random), x_(x), y_(y) {}

    /// Goes to a sample of this pixel; draws start over.
    void startSample(std::uint32_t index) {
        sample_ = index;
        draw_ = 0;
    }
    /// Skips to draw number `draw` of this sample, so that bounce n uses the same draws whatever bounce n-1 needed.
    void seek(int draw) { draw_ = draw; }

    Imath::V2f next2();
    /// One of `parts` points of this draw: those of all samples together are spread as evenly as those of as many
    /// samples with one each.
    Imath::V2f next2(int part, int parts);
    float next1(); ///< the first of next2()

  private:
    const std::array<std::uint32_t, 4>& seedsOf(int draw);

    const KeyedRandom* random_;
    int x_;
    int y_;
    std::uint32_t sample_ = 0;
    int draw_ = 0;
    std::vector<std::array<std::uint32_t, 4>> seeds_; ///< of each draw, made when first needed
};

} // namespace patina
