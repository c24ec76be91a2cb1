#include "surface/chart_overlap.h"

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V2d;

namespace {

double doubleArea(const FlatTriangle& t) {
    return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

// Whether a side of `a` has all of `b` beyond it.
bool separates(const FlatTriangle& a, const FlatTriangle& b) {
    const double sign = doubleArea(a) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; ++i) {
        const V2d side = a[(i + 1) % 3] - a[i];
        const double length = side.length();
        double deepest = -1e300;
        for (const V2d& corner : b) {
            const V2d to = corner - a[i];
            deepest = std::max(deepest, sign * (side.x * to.y - side.y * to.x));
        }
        if (deepest <= 1e-7 * length * length)
            return true;
    }
    return false;
}

} // namespace

bool overlap(const FlatTriangle& a, const FlatTriangle& b) {
    return doubleArea(a) != 0.0 && doubleArea(b) != 0.0 && !separates(a, b) && !separates(b, a);
}

bool FlatTriangles::add(const FlatTriangle& triangle) {
    const auto cellOf = [&](double x) { return static_cast<std::int32_t>(std::floor(x / cell_)); };
    const auto [left, right] = std::minmax({triangle[0].x, triangle[1].x, triangle[2].x});
    const auto [low, high] = std::minmax({triangle[0].y, triangle[1].y, triangle[2].y});
    const auto eachCell = [&](const auto& use) {
        for (std::int32_t j = cellOf(low); j <= cellOf(high); ++j)
            for (std::int32_t i = cellOf(left); i <= cellOf(right); ++i)
                use(std::uint64_t(std::uint32_t(i)) << 32 | std::uint32_t(j));
    };
    bool isFree = true;
    eachCell([&](std::uint64_t key) {
        const auto found = isFree ? cells_.find(key) : cells_.end();
        if (found != cells_.end())
            isFree = std::none_of(found->second.begin(), found->second.end(),
                                  [&](int other) { return overlap(triangles_[other], triangle); });
    });
    if (!isFree)
        return false;
    eachCell([&](std::uint64_t key) { cells_[key].push_back(static_cast<int>(triangles_.size())); });
    triangles_.push_back(triangle);
    return true;
}

} // namespace patina
