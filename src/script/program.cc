#include "script/program.h"

#include <algorithm>

namespace patina {

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
    return before->second + share * (after->second - before->second);
}

} // namespace patina
