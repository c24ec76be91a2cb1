#include "surface/hole_cap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace patina {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

constexpr int mostCorners = 200; // the search takes the cube of it
constexpr double forbidden = 1e6; // times the rim's square: only where nothing else is left

double area(const V3d& a, const V3d& b, const V3d& c) {
    return 0.5 * (b - a).cross(c - a).length();
}

} // namespace

std::vector<V3i> capHole(const std::vector<V3f>& rim, const std::function<bool(int, int)>& allowed) {
    std::vector<V3d> p(rim.begin(), rim.end());
    std::vector<int> left(rim.size());
    std::iota(left.begin(), left.end(), 0);
    std::vector<V3i> triangles;
    double length = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i)
        length += (p[(i + 1) % p.size()] - p[i]).length();
    const double penalty = forbidden * std::max(length * length, 1e-300);

    // Corners cut off while there are too many: the one whose neighbours come closest.
    while (static_cast<int>(left.size()) > mostCorners) {
        const std::size_t n = left.size();
        std::size_t best = 0;
        double shortest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < n; ++i) {
            const int a = left[(i + n - 1) % n], c = left[(i + 1) % n];
            double span = (p[a] - p[c]).length();
            if (allowed && !allowed(a, c))
                span += penalty;
            if (span < shortest) {
                shortest = span;
                best = i;
            }
        }
        triangles.emplace_back(left[(best + n - 1) % n], left[best], left[(best + 1) % n]);
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    const int n = static_cast<int>(left.size());
    if (n < 3)
        return triangles;

    // least[i][j]: the least area of the part of the polygon between corners i and j; through[i][j]: its triangle's tip.
    std::vector<double> least(static_cast<std::size_t>(n) * n, 0.0);
    std::vector<int> through(least.size(), -1);
    const auto at = [n](int i, int j) { return static_cast<std::size_t>(i) * n + j; };
    for (int span = 2; span < n; ++span)
        for (int i = 0; i + span < n; ++i) {
            const int j = i + span;
            double best = std::numeric_limits<double>::infinity();
            for (int k = i + 1; k < j; ++k) {
                const double sum = least[at(i, k)] + least[at(k, j)] + area(p[left[i]], p[left[k]], p[left[j]]);
                if (sum < best) {
                    best = sum;
                    through[at(i, j)] = k;
                }
            }
            const bool isRim = i == 0 && j == n - 1;
            if (!isRim && allowed && !allowed(left[i], left[j]))
                best += penalty;
            least[at(i, j)] = best;
        }
    std::vector<std::pair<int, int>> parts = {{0, n - 1}};
    while (!parts.empty()) {
        const auto [i, j] = parts.back();
        parts.pop_back();
        if (j - i < 2)
            continue;
        const int k = through[at(i, j)];
        triangles.emplace_back(left[i], left[k], left[j]);
        parts.emplace_back(i, k);
        parts.emplace_back(k, j);
    }
    return triangles;
}

} // namespace patina
