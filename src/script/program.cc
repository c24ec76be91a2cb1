#include "script/program.h"

#include <algorithm>

namespace patina {

namespace {

// The slope of a monotone cubic at a point (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984): the
// weighted harmonic mean of the slopes on its two sides, none where they disagree in sign; level at both ends, where
// the curve is held.
double slopeAt(const std::vector<std::pair<double, double>>& points, std::size_t i) {
    if (i == 0 || i + 1 == points.size())
        return 0.0;
    const double left = points[i].first - points[i - 1].first, right = points[i + 1].first - points[i].first;
    const double before = (points[i].second - points[i - 1].second) / left;
    const double after = (points[i + 1].second - points[i].second) / right;
    if (before * after <= 0.0)
        return 0.0;
    const double share = (left + 2.0 * right) / (3.0 * (left + right));
    return before * after / (share * after + (1.0 - share) * before);
}

} // namespace

double Curve::value(double x) const {
    if (points.empty())
        return 0.0;
    const auto after = std::upper_bound(points.begin(), points.end(), x,
                                        [](double year, const auto& point) { return year < point.first; });
    if (after == points.begin())
        return points.front().second;
    if (after == points.end())
        return points.back().second;
    const auto before = after - 1;
    const double share = (x - before->first) / (after->first - before->first);
    if (!isSmooth)
        return before->second + share * (after->second - before->second);
    const auto first = static_cast<std::size_t>(before - points.begin());
    const double width = after->first - before->first;
    const double square = share * share, cube = square * share;
    return (2.0 * cube - 3.0 * square + 1.0) * before->second + (3.0 * square - 2.0 * cube) * after->second +
           width *
               ((cube - 2.0 * square + share) * slopeAt(points, first) + (cube - square) * slopeAt(points, first + 1));
}

} // namespace patina
