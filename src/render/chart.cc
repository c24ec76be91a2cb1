#include "render/chart.h"

#include "base/errors.h"
#include "render/axis_step.h"
#include "render/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

const Imath::V3f paper(0.965f, 0.965f, 0.96f), ink(0.13f, 0.13f, 0.14f), rule(0.86f, 0.86f, 0.85f);

double valueAt(const ChartSeries& series, double x) {
    const auto after = std::lower_bound(series.x.begin(), series.x.end(), x);
    if (after == series.x.begin())
        return series.y.front();
    if (after == series.x.end())
        return series.y.back();
    const std::size_t i = std::size_t(after - series.x.begin());
    const double span = series.x[i] - series.x[i - 1];
    return series.y[i - 1] + (series.y[i] - series.y[i - 1]) * (span > 0.0 ? (x - series.x[i - 1]) / span : 1.0);
}

struct Axes {
    int left, top, width, height;
    double xLeast, xMost, yMost;

    double xAt(int column) const { return xLeast + (xMost - xLeast) * (column + 0.5) / width; }
    double rowOf(double y) const { return top + height * (1.0 - y / yMost); }
};

void check(const std::vector<ChartSeries>& series) {
    if (series.empty())
        throw RunError("chart", "there is nothing to draw");
    for (const ChartSeries& one : series) {
        if (one.x.empty() || one.x.size() != one.y.size() || !std::is_sorted(one.x.begin(), one.x.end()))
            throw RunError("chart", fmt::format("'{}' is no course over x", one.name));
        for (std::size_t i = 0; i < one.x.size(); ++i)
            if (!(one.y[i] >= 0.0) || !(one.x[i] >= 0.0) || !std::isfinite(one.y[i]) || !std::isfinite(one.x[i]))
                throw RunError("chart", fmt::format("'{}' has a value below 0 or none at all", one.name));
    }
}

// A column of pixels between two heights, its ends blended by how much of their pixel they cover.
void drawSpan(Image& image, int x, double from, double to, const Imath::V3f& colour, const Axes& axes) {
    from = std::max(from, double(axes.top));
    to = std::min(to, double(axes.top + axes.height));
    for (int y = static_cast<int>(std::floor(from)); y < to; ++y) {
        const float cover = float(std::clamp(std::min(to, y + 1.0) - std::max(from, double(y)), 0.0, 1.0));
        image.setRgb(x, y, image.rgb(x, y) + (colour - image.rgb(x, y)) * cover);
    }
}

} // namespace

Chart drawChart(const std::vector<ChartSeries>& series, const ChartOptions& options) {
    check(series);
    if (options.width < 200 || options.height < 110)
        throw RunError("chart", "it is too small for its axes", "make it 200 × 110 pixels at least");
    Chart chart;
    chart.image = Image(options.width, options.height);
    for (int y = 0; y < options.height; ++y)
        for (int x = 0; x < options.width; ++x)
            chart.image.setRgb(x, y, paper);

    double xMost = 0.0, yMost = 0.0;
    for (const ChartSeries& one : series)
        xMost = std::max(xMost, one.x.back());
    for (std::size_t i = 0; i < series.front().x.size() && options.stacked; ++i) {
        double sum = 0.0;
        for (const ChartSeries& one : series)
            sum += valueAt(one, series.front().x[i]);
        yMost = std::max(yMost, sum);
    }
    for (const ChartSeries& one : series)
        yMost = std::max(yMost, *std::max_element(one.y.begin(), one.y.end()));
    const double xLeast = options.xFirst;
    if (!(xMost > xLeast))
        xMost = xLeast + 1.0;
    if (!(yMost > 0.0))
        yMost = 1.0;
    const double xStep = axisStep(xMost - xLeast, 6), yStep = axisStep(yMost, 4);
    yMost = yStep * std::ceil(yMost / yStep - 1e-9);

    const int letters = std::clamp(options.width / 44, 10, 24);
    const int legend = 12 * letters;
    const Axes axes{4 * letters,
                    options.title.empty() ? letters * 3 / 2 : 3 * letters,
                    std::max(16, options.width - legend - 5 * letters),
                    std::max(16, options.height - (options.title.empty() ? 5 : 7) * letters),
                    xLeast,
                    xMost,
                    yMost};
    const auto text = [&](const std::string& words, double x, double y, TextAlign align, float widest = 0.f) {
        chart.hasText = drawText(chart.image, words, float(x), float(y), letters, ink, align, widest) && chart.hasText;
    };
    for (double y = 0.0; y <= yMost * (1.0 + 1e-9); y += yStep) {
        const int row = std::min(axes.top + axes.height, static_cast<int>(std::lround(axes.rowOf(y))));
        for (int x = axes.left; x < axes.left + axes.width; ++x)
            chart.image.setRgb(x, row, rule);
        text(fmt::format("{:g}", y), axes.left - letters / 2, row + letters / 3, TextAlign::right);
    }
    for (int column = 0; column < axes.width; ++column) {
        const double x = axes.xAt(column);
        double sum = 0.0;
        for (const ChartSeries& one : series) {
            const double y = valueAt(one, x);
            if (options.stacked) {
                drawSpan(chart.image, axes.left + column, axes.rowOf(sum + y), axes.rowOf(sum), one.colour, axes);
                sum += y;
            } else {
                // As high as the line is steep within the pixel, and two pixels at least.
                const double before = axes.rowOf(valueAt(one, axes.xAt(column - 1)));
                const double row = axes.rowOf(y);
                drawSpan(chart.image, axes.left + column, std::min(before, row) - 1.0, std::max(before, row) + 1.0,
                         one.colour, axes);
            }
        }
    }
    for (int y = axes.top; y <= axes.top + axes.height; ++y)
        chart.image.setRgb(axes.left, y, ink);
    for (int x = axes.left; x < axes.left + axes.width; ++x)
        chart.image.setRgb(x, axes.top + axes.height, ink);
    for (double x = xStep * std::ceil(xLeast / xStep - 1e-9); x <= xMost * (1.0 + 1e-9); x += xStep)
        text(fmt::format("{:g}", x + 0.0), // not "-0"
             axes.left + axes.width * (x - xLeast) / (xMost - xLeast), axes.top + axes.height + 1.4 * letters,
             TextAlign::centre);

    text(options.title, axes.left, 1.8 * letters, TextAlign::left, float(options.width - axes.left));
    text(options.xLabel, axes.left + 0.5 * axes.width, axes.top + axes.height + 2.8 * letters, TextAlign::centre);
    text(options.yLabel, axes.left + letters / 2, axes.top - 0.4 * letters, TextAlign::left);
    double y = axes.top + 1.5 * letters;
    for (std::size_t i = 0; i < series.size(); ++i, y += 1.7 * letters) {
        const ChartSeries& one = series[options.stacked ? series.size() - 1 - i : i];
        const int left = axes.left + axes.width + letters;
        for (int row = static_cast<int>(y) - letters + 2; row < y + 2 && row < chart.image.height; ++row)
            for (int x = left; x < left + letters && x < chart.image.width; ++x)
                chart.image.setRgb(x, row, one.colour);
        text(one.name, left + 1.5 * letters, y, TextAlign::left, float(legend - 2.5 * letters));
    }
    return chart;
}

} // namespace patina
