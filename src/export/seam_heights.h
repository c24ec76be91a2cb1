#pragma once
// Heights that agree on both sides of UV seams.

#include "export/texel_map.h"
#include "export/texel_sampler.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace patina {

/// The heights of the texels that a bilinear read along a seam asks, moved so that it has the same value on both sides.
///
/// The texels of two charts lie on different lattices. Each holds the right height in its middle, but between them a
/// bilinear read is off by an eighth of the squared texel times the curvature, differently on either side: the
/// displaced mesh would open there. "Both reads are equal" at points half a texel apart and less are the rows of a
/// sparse linear system; of all heights that fulfil it those nearest to what was read are taken (Kaczmarz's
/// projections, forth and back; where rows contradict each other they end near the least squares). Where reads differ
/// by more than a voxel they end on different sheets, as a rule under the fold mask, and stay as they are.
class SeamHeights {
  public:
    /// \param tiles  as uvTiles() lists them \param map  the texels of the first of them, gutters included; the maps of
    /// the others are made and dropped again
    SeamHeights(const SurfaceWalk& walk, const TexelSampler& sampler, const std::vector<std::uint8_t>& pointsAcross,
                const std::vector<Imath::V2i>& tiles, const TexelMap& map, int gutterTexels);

    /// Calls use(x, height) for the texels of a row that seams ask, by x; heights in scene units of the volume, as
    /// drawn.
    template <typename Use>
    void eachOfRow(std::size_t tile, int y, const Use& use) const {
        const std::uint64_t start = std::uint64_t(tile) << 32 | static_cast<std::uint64_t>(y) * size_;
        for (auto at = std::lower_bound(keys_.begin(), keys_.end(), start); at != keys_.end() && *at < start + size_;
             ++at)
            use(static_cast<int>(*at - start), double(heights_[at - keys_.begin()]));
    }

    /// Texels that seams ask.
    std::size_t count() const { return heights_.size(); }

  private:
    std::uint64_t size_ = 0;          // of a map's side, texels
    std::vector<std::uint64_t> keys_; // tile, texel; sorted
    std::vector<float> heights_;
};

} // namespace patina
