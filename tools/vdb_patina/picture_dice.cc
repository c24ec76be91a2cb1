#include "picture_dice.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>

namespace patina::tool {

using Imath::V3f;

namespace {

// diced() without neighbours: whether an edge is too long depends on nothing but the edge.
class DiceCount {
  public:
    DiceCount(const Camera& camera, const DiceOptions& options) : camera_(camera), options_(options) {}

    std::size_t of(const std::array<V3f, 3>& corner, int rounds) const {
        if (rounds == 0)
            return 1;
        std::array<float, 3> length;
        std::array<bool, 3> splits;
        for (std::size_t i = 0; i < 3; ++i) {
            const V3f &a = corner[i], &b = corner[(i + 1) % 3];
            length[i] = (a - b).length();
            splits[i] = isTooLong(0.5f * (a + b), length[i]);
        }
        const auto count = std::count(splits.begin(), splits.end(), true);
        if (count == 0)
            return 1;
        const auto longest = std::size_t(std::max_element(length.begin(), length.end()) - length.begin());
        const auto middleOf = [&](std::size_t i) { return 0.5f * (corner[i] + corner[(i + 1) % 3]); };
        if (!camera_.sees(middleOf(longest), length[longest] + options_.margin))
            return 1;
        const auto parts = [&](const V3f& a, const V3f& b, const V3f& c) { return of({a, b, c}, rounds - 1); };
        // Turned so that edge 0 is split and, of two, edge 2 is not.
        std::size_t first = 0;
        while (!splits[first] || (count == 2 && splits[(first + 2) % 3]))
            ++first;
        const V3f &a = corner[first], &b = corner[(first + 1) % 3], &c = corner[(first + 2) % 3];
        const V3f ab = middleOf(first);
        if (count == 1)
            return parts(a, ab, c) + parts(ab, b, c);
        const V3f bc = middleOf((first + 1) % 3);
        if (count == 3) {
            const V3f ca = middleOf((first + 2) % 3);
            return parts(a, ab, ca) + parts(b, bc, ab) + parts(c, ca, bc) + parts(ab, bc, ca);
        }
        const bool fromA = (a - bc).length2() <= (ab - c).length2();
        return parts(ab, b, bc) + (fromA ? parts(a, ab, bc) + parts(a, bc, c) : parts(a, ab, c) + parts(ab, bc, c));
    }

    bool isTurnedAway(const SurfaceMesh& surface, const Imath::V3i& triangle) const {
        for (int i = 0; i < 3; ++i) {
            const auto v = std::size_t(triangle[i]);
            if ((surface.normals[v] ^ (camera_.position() - surface.positions[v]).normalized()) > -0.3f)
                return false;
        }
        return true;
    }

  private:
    bool isTooLong(const V3f& middle, float length) const {
        if (length > options_.longestEdge)
            return true;
        const float depth = std::max((middle - camera_.position()) ^ camera_.forward(), 0.5f * length);
        return length > options_.pixelsPerEdge * camera_.pixelAt(depth, options_.pictureHeight);
    }

    const Camera& camera_;
    const DiceOptions& options_;
};

} // namespace

DiceOptions dicingOf(const View& view, const Options& options, double voxel) {
    DiceOptions dice;
    dice.pictureHeight = view.height;
    dice.pixelsPerEdge = float(options.dice);
    dice.longestEdge = 1.5f * float(voxel);
    dice.margin = float(voxel);
    return dice;
}

std::size_t dicedTriangles(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options) {
    const DiceCount count(camera, options);
    const auto after = [&](int rounds) {
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, surface.triangles.size(), 256), std::size_t(0),
            [&](const tbb::blocked_range<std::size_t>& range, std::size_t sum) {
                for (std::size_t n = range.begin(); n != range.end(); ++n) {
                    const Imath::V3i& t = surface.triangles[n];
                    if (surface.closed && count.isTurnedAway(surface, t))
                        ++sum;
                    else
                        sum += count.of({surface.positions[std::size_t(t.x)], surface.positions[std::size_t(t.y)],
                                         surface.positions[std::size_t(t.z)]},
                                        rounds);
                }
                return sum;
            },
            std::plus<>());
    };
    // Round by round: the one in which there are too many is the last.
    std::size_t triangles = surface.triangles.size();
    for (int round = 1; round <= 24 && triangles <= options.mostTriangles; ++round) {
        const std::size_t split = after(round);
        if (split == triangles)
            break;
        triangles = split;
    }
    return triangles;
}

} // namespace patina::tool
