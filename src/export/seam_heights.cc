#include "export/seam_heights.h"

#include "export/seam_pieces.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <optional>

namespace patina {

using Imath::V2i;

namespace {

constexpr double allowed = 0.01; // jump, voxels
// How far a texel may be moved from what was read there, voxels. Where texels of very different shapes meet, as where UVs
// are stretched, equal reads would ask for more than a voxel.
constexpr double farthest = 0.15;
constexpr int wallSweeps = 32, mostSweeps = 500;

// The point that a texel shows; nullopt beyond the rim.
std::optional<SurfacePoint> shownAt(const TexelMap& map, std::uint32_t texel) {
    if (map.points[texel].triangle >= 0)
        return map.points[texel];
    const auto rim = std::lower_bound(map.rim.begin(), map.rim.end(), texel,
                                      [](const RimTexel& item, std::uint32_t value) { return item.texel < value; });
    if (rim != map.rim.end() && rim->texel == texel)
        return rim->shown;
    return std::nullopt;
}

// Moves the texels of a piece by as little as takes its jumps away: x -= A^T (A A^T + c)^-1 A x, A the weights at its
// start, in its middle and at its end. In short pieces these are nearly the same, whence c, with which most pieces hold
// after the fewest sweeps.
void level(const SeamPiece& piece, std::vector<float>& heights) {
    constexpr double damping = 0.1;
    const std::array<std::array<float, 8>, 3> weights = {piece.weights(0), piece.weights(1), piece.weights(2)};
    double matrix[3][3], moves[3];
    for (int i = 0; i < 3; ++i) {
        moves[i] = 0.0;
        for (int k = 0; k < 8; ++k)
            moves[i] += double(weights[i][k]) * heights[piece.texels[k]];
        for (int j = 0; j < 3; ++j) {
            matrix[i][j] = i == j ? damping : 0.0;
            for (int k = 0; k < 8; ++k)
                matrix[i][j] += double(weights[i][k]) * weights[j][k];
        }
    }
    // Symmetric and positive: elimination needs no pivots.
    for (int i = 0; i < 3; ++i)
        for (int j = i + 1; j < 3; ++j) {
            const double factor = matrix[j][i] / matrix[i][i];
            for (int k = i; k < 3; ++k)
                matrix[j][k] -= factor * matrix[i][k];
            moves[j] -= factor * moves[i];
        }
    for (int i = 2; i >= 0; --i) {
        for (int j = i + 1; j < 3; ++j)
            moves[i] -= matrix[i][j] * moves[j];
        moves[i] /= matrix[i][i];
    }
    for (int k = 0; k < 8; ++k)
        heights[piece.texels[k]] -= static_cast<float>(moves[0] * weights[0][k] + moves[1] * weights[1][k] +
                                                       moves[2] * weights[2][k]);
}

// Which pieces read a texel.
struct Readers {
    std::vector<std::uint32_t> first, pieces; // of texel i: pieces[first[i]] … pieces[first[i + 1] - 1]

    Readers(const std::vector<SeamPiece>& all, std::size_t texels) : first(texels + 1), pieces(all.size() * 8) {
        for (const SeamPiece& piece : all)
            for (const std::uint64_t texel : piece.texels)
                ++first[texel];
        std::uint32_t sum = 0;
        for (std::uint32_t& count : first)
            count = sum += count;
        for (std::size_t p = all.size(); p-- > 0;)
            for (const std::uint64_t texel : all[p].texels)
                pieces[--first[texel]] = static_cast<std::uint32_t>(p);
    }
};

// Levels pieces until none jumps by more than `bound`, at most sweeps[p] times round; texels stay within `moves` of their
// heights.
void levelAll(const std::vector<SeamPiece>& pieces, const std::vector<short>& sweeps, float bound,
              const std::vector<float>& moves, std::vector<float>& heights) {
    const std::vector<float> given = heights;
    const Readers readers(pieces, heights.size());
    std::vector<std::uint32_t> asked, next;
    for (std::size_t p = 0; p < pieces.size(); ++p)
        if (sweeps[p] > 0)
            asked.push_back(static_cast<std::uint32_t>(p));
    std::vector<char> jumps, isNext(pieces.size());
    for (int sweep = 0; !asked.empty(); ++sweep) {
        jumps.resize(asked.size());
        tbb::parallel_for(std::size_t(0), asked.size(), [&](std::size_t i) {
            jumps[i] = sweep < sweeps[asked[i]] && pieces[asked[i]].largestJump(heights) > bound;
        });
        // One after the other, so that the order and with it every bit is the same on any number of threads. Asked again
        // is what reads texels that were moved.
        next.clear();
        for (std::size_t i = 0; i < asked.size(); ++i) {
            if (!jumps[i])
                continue;
            const SeamPiece& piece = pieces[asked[i]];
            level(piece, heights);
            for (const std::uint64_t texel : piece.texels) {
                heights[texel] = std::clamp(heights[texel], given[texel] - moves[texel], given[texel] + moves[texel]);
                for (std::uint32_t r = readers.first[texel]; r < readers.first[texel + 1]; ++r) {
                    const std::uint32_t reader = readers.pieces[r];
                    if (!isNext[reader] && sweeps[reader] > sweep + 1) {
                        isNext[reader] = 1;
                        next.push_back(reader);
                    }
                }
            }
        }
        asked.swap(next);
        for (const std::uint32_t p : asked)
            isNext[p] = 0;
        tbb::parallel_sort(asked.begin(), asked.end());
    }
}

} // namespace

SeamHeights::SeamHeights(const SurfaceWalk& walk, const TexelSampler& sampler,
                         const std::vector<std::uint8_t>& pointsAcross, const std::vector<V2i>& tiles,
                         const TexelMap& map, int gutterTexels) {
    size_ = static_cast<std::uint64_t>(map.size);
    if (map.size < 2)
        return;
    std::vector<SeamPiece> pieces = seamPieces(walk, tiles, map.size, sampler.voxelSize());
    keys_.reserve(pieces.size() * 8);
    for (const SeamPiece& piece : pieces)
        keys_.insert(keys_.end(), piece.texels.begin(), piece.texels.end());
    tbb::parallel_sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    keys_.shrink_to_fit();

    heights_.assign(keys_.size(), 0.f);
    std::vector<char> known(keys_.size());
    tbb::enumerable_thread_specific<TexelSampler::Scratch> scratch;
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
        const auto placeOf = [&](std::uint64_t key) {
            return static_cast<std::size_t>(std::lower_bound(keys_.begin(), keys_.end(), key) - keys_.begin());
        };
        const std::size_t first = placeOf(seamKey(tile, 0)), last = placeOf(seamKey(tile + 1, 0));
        if (first == last)
            continue;
        TexelMap made;
        if (tile > 0)
            made = makeTexelMap(walk, map.size, gutterTexels, tiles[tile]);
        const TexelMap& texels = tile > 0 ? made : map;
        tbb::parallel_for(first, last, [&](std::size_t i) {
            const auto shown = shownAt(texels, static_cast<std::uint32_t>(keys_[i]));
            known[i] = shown.has_value();
            if (shown)
                heights_[i] =
                    static_cast<float>(sampler.height(*shown, pointsAcross[shown->triangle], scratch.local()));
        });
    }

    // Places in the list instead of keys. What jumps by a voxel or cannot be told stays as it is.
    const auto voxel = static_cast<float>(sampler.voxelSize());
    std::vector<short> sweeps(pieces.size());
    std::vector<char> isOpen(pieces.size());
    tbb::parallel_for(std::size_t(0), pieces.size(), [&](std::size_t p) {
        bool whole = true;
        for (std::uint64_t& texel : pieces[p].texels) {
            texel = static_cast<std::uint64_t>(std::lower_bound(keys_.begin(), keys_.end(), texel) - keys_.begin());
            whole = whole && known[texel];
        }
        isOpen[p] = whole && pieces[p].crossesWall(heights_);
        if (whole && pieces[p].largestJump(heights_) < voxel)
            sweeps[p] = isOpen[p] ? wallSweeps : mostSweeps;
    });
    open_.assign(keys_.size(), 0);
    const auto markOpen = [&](const SeamPiece& piece) {
        for (const std::uint64_t texel : piece.texels)
            open_[texel] = 1;
    };
    for (std::size_t p = 0; p < pieces.size(); ++p)
        if (isOpen[p])
            markOpen(pieces[p]);
    // At walls, under the fold mask, closed seams are worth more than right heights.
    std::vector<float> moves(keys_.size());
    for (std::size_t i = 0; i < moves.size(); ++i)
        moves[i] = open_[i] ? 1e3f * voxel : static_cast<float>(farthest) * voxel;
    const float bound = static_cast<float>(allowed) * voxel;
    levelAll(pieces, sweeps, bound, moves, heights_);
    for (const SeamPiece& piece : pieces)
        if (piece.largestJump(heights_) > bound)
            markOpen(piece);

    // Beyond the rim nothing was read.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keys_.size(); ++i)
        if (known[i]) {
            keys_[kept] = keys_[i];
            heights_[kept] = heights_[i];
            open_[kept++] = open_[i];
        }
    keys_.resize(kept);
    heights_.resize(kept);
    open_.resize(kept);
}

} // namespace patina
