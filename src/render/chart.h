#pragma once
// Plain charts: lines over an axis, or areas stacked on each other.

#include "render/image.h"

#include <Imath/ImathVec.h>

#include <string>
#include <vector>

namespace patina {

/// One course over x. Points sorted by x; straight lines between them.
struct ChartSeries {
    std::string name;
    Imath::V3f colour; ///< encoded for display
    std::vector<double> x, y;
};

struct ChartOptions {
    int width = 640, height = 400; ///< pixels
    std::string title, xLabel, yLabel;
    double xFirst = 0.0;  ///< where the x axis begins
    bool stacked = false; ///< areas on top of each other, the first one at the bottom; all series have the same x
};

struct Chart {
    Image image; ///< encoded for display
    bool hasText = true;
};

/// The axes begin at 0 (x: at xFirst); y ends at a round number. Names stand in a legend on the right.
/// \throws RunError where there is nothing to draw or a value is negative or not finite
Chart drawChart(const std::vector<ChartSeries>& series, const ChartOptions& options);

} // namespace patina
