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
/// displaced mesh would open there. Along each piece of a seam (seam_pieces.h) the jump may be a hundredth of a voxel;
/// where it is more, the eight texels are moved by the least that takes it away, piece by piece until all hold
/// (projections on to convex sets). So no point of a seam jumps by more than 0.0125 voxel, but where that would move a
/// texel by more than 0.15 voxel (stretched UVs), and at walls: where heights jump from texel to texel, as they end on
/// different sheets, seams are closed as far as some dozens of rounds do. Texels there belong under the fold mask.
class SeamHeights {
  public:
    /// \param tiles  as uvTiles() lists them \param map  the texels of the first of them, gutters included; the maps of
    /// the others are made and dropped again
    SeamHeights(const SurfaceWalk& walk, const TexelSampler& sampler, const std::vector<std::uint8_t>& pointsAcross,
                const std::vector<Imath::V2i>& tiles, const TexelMap& map, int gutterTexels);

    /// Calls use(x, height, open) for the texels of a row that seams ask, by x; heights in scene units of the volume,
    /// as drawn; open: the seam is not closed there, or a wall is.
    template <typename Use>
    void eachOfRow(std::size_t tile, int y, const Use& use) const {
        const std::uint64_t start = std::uint64_t(tile) << 32 | static_cast<std::uint64_t>(y) * size_;
        for (auto at = std::lower_bound(keys_.begin(), keys_.end(), start); at != keys_.end() && *at < start + size_;
             ++at) {
            const auto i = static_cast<std::size_t>(at - keys_.begin());
            use(static_cast<int>(*at - start), double(heights_[i]), open_[i] != 0);
        }
    }

    /// Texels that seams ask.
    std::size_t count() const { return heights_.size(); }

  private:
    std::uint64_t size_ = 0;          // of a map's side, texels
    std::vector<std::uint64_t> keys_; // seamKey(); sorted
    std::vector<float> heights_;
    std::vector<char> open_;
};

} // namespace patina
