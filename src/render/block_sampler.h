#pragma once
// The random numbers of a block of pixels, for many paths at once.

#include "base/random.h"

#include <Imath/ImathVec.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patina {

/// PixelSampler's numbers, to the bit, of paths that are counted pixel by pixel and sample by sample. Its memory is
/// kept from block to block.
class BlockSampler {
  public:
    explicit BlockSampler(const KeyedRandom& random) : random_(&random) {}

    void begin(const std::vector<Imath::V2i>& pixels);
    /// Paths 0, 1, … are now samples first … last - 1 of the first pixel, then those of the second …
    void take(int first, int last);
    std::size_t paths() const { return pixelOf_.size(); }

    /// Draw number `draw` of these paths, which has room up to the next multiple of 16 and valid numbers there; so have
    /// u and v.
    /// \param part  one of `parts` points of this draw: those of all samples together are spread as evenly as those of
    /// as
    ///              many samples with one each
    void draw(int draw, const std::vector<int>& path, std::size_t count, float* u, float* v, int part = 0,
              int parts = 1);

  private:
    struct Seeds {
        std::vector<std::uint32_t> first, second, third; ///< of each pixel
    };

    const KeyedRandom* random_;
    std::vector<Imath::V2i> pixels_;
    std::vector<Seeds> seeds_;    ///< of each draw
    std::vector<char> seedsMade_; ///< for this block
    std::vector<std::int32_t> pixelOf_;
    std::vector<std::uint32_t> sampleOf_;
    std::vector<std::uint32_t> partOf_; ///< the same of one part
};

} // namespace patina
