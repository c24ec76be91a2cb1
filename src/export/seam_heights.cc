#include "export/seam_heights.h"

#include "surface/uv_frame.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace patina {

using Imath::V2d;
using Imath::V2i;

namespace {

constexpr int sweeps = 64; // by then the jumps of scans change in their third digit only
constexpr std::uint64_t noKey = ~std::uint64_t(0);

// Reads of four texels on one side of a seam less those of four on the other.
struct Equation {
    std::array<std::uint64_t, 8> keys; // later: places in the list of unknowns
    std::array<float, 8> weights;
    float squared; // their squares' sum
};

float jumpOf(const Equation& equation, const std::vector<float>& heights) {
    float sum = 0.f;
    for (int i = 0; i < 8; ++i)
        sum += equation.weights[i] * heights[equation.keys[i]];
    return sum;
}

std::uint64_t keyOf(std::size_t tile, std::uint32_t texel) {
    return std::uint64_t(tile) << 32 | texel;
}

void addRead(const V2d& place, int size, std::size_t tile, float sign, int first, Equation& equation) {
    const int x0 = static_cast<int>(std::floor(place.x)), y0 = static_cast<int>(std::floor(place.y));
    for (int i = 0; i < 4; ++i) {
        const int x = std::clamp(x0 + i % 2, 0, size - 1), y = std::clamp(y0 + i / 2, 0, size - 1);
        const double along = place.x - x0, down = place.y - y0;
        const double weight = (i % 2 ? along : 1.0 - along) * (i / 2 ? down : 1.0 - down);
        equation.keys[first + i] = keyOf(tile, static_cast<std::uint32_t>(static_cast<std::size_t>(y) * size + x));
        equation.weights[first + i] = sign * static_cast<float>(weight);
    }
}

std::vector<Equation> equationsOf(const SurfaceWalk& walk, const std::vector<V2i>& tiles, int size) {
    const SurfaceMesh& surface = walk.surface();
    const auto tileIndex = [&](int triangle) {
        return static_cast<std::size_t>(std::find(tiles.begin(), tiles.end(), tileOf(surface, triangle)) -
                                        tiles.begin());
    };
    std::vector<Equation> equations;
    for (int t = 0; t < static_cast<int>(surface.triangleUvs.size()); ++t)
        for (int edge = 0; edge < 3; ++edge) {
            const int other = walk.behind(t, edge);
            if (other < 3 * t + edge || !isSeam(walk, t, edge)) // none, or seen from there
                continue;
            const int there = other / 3;
            const std::size_t tileHere = tileIndex(t), tileThere = tileIndex(there);
            if (tileHere >= tiles.size() || tileThere >= tiles.size() || !uvDerivativesOf(surface, t).valid ||
                !uvDerivativesOf(surface, there).valid)
                continue;
            const V2i &tileA = tiles[tileHere], &tileB = tiles[tileThere];
            const V2d a0 = texelPlace(surface, t, edge, size, tileA);
            const V2d a1 = texelPlace(surface, t, (edge + 1) % 3, size, tileA);
            const V2d b1 = texelPlace(surface, there, other % 3, size, tileB);
            const V2d b0 = texelPlace(surface, there, (other % 3 + 1) % 3, size, tileB);
            const int points =
                std::max(1, static_cast<int>(std::ceil(2.0 * std::max((a1 - a0).length(), (b1 - b0).length()))));
            for (int i = 0; i < points; ++i) {
                const double s = (i + 0.5) / points;
                Equation equation;
                addRead(a0 + (a1 - a0) * s, size, tileHere, 1.f, 0, equation);
                addRead(b0 + (b1 - b0) * s, size, tileThere, -1.f, 4, equation);
                equations.push_back(equation);
            }
        }
    return equations;
}

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

} // namespace

SeamHeights::SeamHeights(const SurfaceWalk& walk, const TexelSampler& sampler,
                         const std::vector<std::uint8_t>& pointsAcross, const std::vector<V2i>& tiles,
                         const TexelMap& map, int gutterTexels) {
    size_ = static_cast<std::uint64_t>(map.size);
    std::vector<Equation> equations = equationsOf(walk, tiles, map.size);
    keys_.reserve(equations.size() * 8);
    for (const Equation& equation : equations)
        keys_.insert(keys_.end(), equation.keys.begin(), equation.keys.end());
    tbb::parallel_sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    keys_.shrink_to_fit();

    heights_.assign(keys_.size(), 0.f);
    std::vector<char> known(keys_.size());
    tbb::enumerable_thread_specific<TexelSampler::Scratch> scratch;
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
        const auto first =
            static_cast<std::size_t>(std::lower_bound(keys_.begin(), keys_.end(), keyOf(tile, 0)) - keys_.begin());
        const auto last =
            static_cast<std::size_t>(std::lower_bound(keys_.begin(), keys_.end(), keyOf(tile + 1, 0)) - keys_.begin());
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

    // Places in the list instead of keys; what cannot be told is left out.
    const float apart = static_cast<float>(sampler.voxelSize());
    tbb::parallel_for(std::size_t(0), equations.size(), [&](std::size_t e) {
        Equation& equation = equations[e];
        bool whole = true;
        for (auto& key : equation.keys) {
            key = static_cast<std::uint64_t>(std::lower_bound(keys_.begin(), keys_.end(), key) - keys_.begin());
            whole = whole && known[key];
        }
        equation.squared = 0.f;
        for (const float weight : equation.weights)
            equation.squared += weight * weight;
        if (!whole || !(std::abs(jumpOf(equation, heights_)) < apart))
            equation.keys[0] = noKey;
    });
    equations.erase(
        std::remove_if(equations.begin(), equations.end(), [](const Equation& e) { return e.keys[0] == noKey; }),
        equations.end());

    const auto project = [&](const Equation& equation) {
        const float step = jumpOf(equation, heights_) / equation.squared;
        for (int i = 0; i < 8; ++i)
            heights_[equation.keys[i]] -= step * equation.weights[i];
    };
    // One after the other, so that the order and with it every bit is the same on any number of threads.
    for (int sweep = 0; sweep < sweeps; ++sweep)
        if (sweep % 2 == 0)
            std::for_each(equations.begin(), equations.end(), project);
        else
            std::for_each(equations.rbegin(), equations.rend(), project);

    // Beyond the rim nothing was read.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keys_.size(); ++i)
        if (known[i]) {
            keys_[kept] = keys_[i];
            heights_[kept++] = heights_[i];
        }
    keys_.resize(kept);
    heights_.resize(kept);
}

} // namespace patina
