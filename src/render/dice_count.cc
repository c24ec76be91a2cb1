#include "render/dice.h"
#include "render/dice_rule.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

// The triangles that one will be after so many rounds, without its neighbours.
std::size_t partsOf(const DiceRule& rule, const DiceRule::Corners& corners, int rounds) {
    if (rounds == 0)
        return 1;
    const auto corner = [&](int i) -> const V3f& { return corners[std::size_t(i % 3)]; };
    bool isSplit[3];
    int count = 0;
    for (int i = 0; i < 3; ++i)
        count += isSplit[i] = rule.isTooLong(corner(i), corner(i + 1));
    if (count == 0 || !rule.isInView(corners))
        return 1;
    const int first = DiceRule::firstCorner(count, [&](int i) { return isSplit[i]; });
    const V3f &a = corner(first), &b = corner(first + 1), &c = corner(first + 2);
    const V3f ab = 0.5f * (a + b), bc = 0.5f * (b + c), ca = 0.5f * (c + a);
    const auto parts = [&](const V3f& p, const V3f& q, const V3f& r) { return partsOf(rule, {p, q, r}, rounds - 1); };
    if (count == 1)
        return parts(a, ab, c) + parts(ab, b, c);
    if (count == 3)
        return parts(a, ab, ca) + parts(b, bc, ab) + parts(c, ca, bc) + parts(ab, bc, ca);
    return parts(ab, b, bc) + (DiceRule::isCutFromA(a, ab, bc, c) ? parts(a, ab, bc) + parts(a, bc, c)
                                                                  : parts(a, ab, c) + parts(ab, bc, c));
}

} // namespace

std::size_t dicedTriangles(const SurfaceMesh& surface, const Camera& camera, const DiceOptions& options) {
    const DiceRule rule(camera, options);
    const auto ofTriangle = [&](const V3i& t, int rounds) -> std::size_t {
        const auto at = [&](const std::vector<V3f>& values) {
            return DiceRule::Corners{values[std::size_t(t.x)], values[std::size_t(t.y)], values[std::size_t(t.z)]};
        };
        const DiceRule::Corners corners = at(surface.positions);
        return surface.closed && rule.isTurnedAway(corners, at(surface.normals)) ? 1 : partsOf(rule, corners, rounds);
    };
    const auto after = [&](int rounds) {
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, surface.triangles.size(), 256), std::size_t(0),
            [&](const tbb::blocked_range<std::size_t>& range, std::size_t sum) {
                for (std::size_t t = range.begin(); t != range.end(); ++t)
                    sum += ofTriangle(surface.triangles[t], rounds);
                return sum;
            },
            std::plus<>());
    };
    // Round by round: the one in which there are too many is the last.
    std::size_t triangles = surface.triangles.size();
    for (int round = 1; round <= mostDiceRounds && triangles <= options.mostTriangles; ++round) {
        const std::size_t split = after(round);
        if (split == triangles)
            break;
        triangles = split;
    }
    return triangles;
}

} // namespace patina
