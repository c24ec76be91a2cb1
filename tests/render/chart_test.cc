#include "render/chart.h"

#include "base/errors.h"

#include <gtest/gtest.h>

#include <limits>

namespace patina {
namespace {

const Imath::V3f red(0.9f, 0.1f, 0.1f), blue(0.1f, 0.1f, 0.9f);

std::size_t pixelsOf(const Image& image, const Imath::V3f& colour) {
    std::size_t count = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            count += (image.rgb(x, y) - colour).length() < 0.05f;
    return count;
}

TEST(Chart, HasTheSizeAskedFor) {
    ChartOptions options;
    options.width = 500;
    options.height = 280;
    const Chart chart = drawChart({{"a", red, {0.0, 10.0}, {0.0, 5.0}}}, options);
    EXPECT_EQ(chart.image.width, 500);
    EXPECT_EQ(chart.image.height, 280);
    EXPECT_GT(pixelsOf(chart.image, red), 100u);
}

// Two areas over the same span cover pixels in the ratio of their integrals.
TEST(Chart, StackedAreasAreAsLargeAsTheirIntegrals) {
    ChartOptions options;
    options.width = 800;
    options.height = 500;
    options.stacked = true;
    const std::vector<double> x{0.0, 10.0};
    const auto areaOf = [&](double first, double second) {
        const Chart chart = drawChart({{"", red, x, {first, first}}, {"", blue, x, {second, second}}}, options);
        return std::pair<double, double>(pixelsOf(chart.image, red), pixelsOf(chart.image, blue));
    };
    const auto [lower, upper] = areaOf(6.0, 2.0);
    // The legend's two patches are of equal size: the difference is free of them.
    const auto [swappedLower, swappedUpper] = areaOf(2.0, 6.0);
    EXPECT_NEAR((lower - swappedLower) / (swappedUpper - upper), 1.0, 0.03);
    EXPECT_NEAR(lower / upper, 3.0, 0.25);
}

TEST(Chart, ALineThatRisesTwiceAsFarIsTwiceAsHigh) {
    ChartOptions options;
    options.width = 600;
    options.height = 400;
    const Chart chart = drawChart(
        {{"", red, {0.0, 10.0}, {4.0, 4.0}}, {"", blue, {0.0, 10.0}, {2.0, 2.0}}, {"", {0, 0.6f, 0}, {0, 10}, {0, 0}}},
        options);
    // The rows where each colour is most frequent: its line.
    const auto row = [&](const Imath::V3f& colour) {
        int best = -1, most = 0;
        for (int y = 0; y < chart.image.height; ++y) {
            int count = 0;
            for (int x = 0; x < chart.image.width; ++x)
                count += (chart.image.rgb(x, y) - colour).length() < 0.1f;
            if (count > most)
                most = count, best = y;
        }
        return best;
    };
    const int zero = row({0.f, 0.6f, 0.f});
    EXPECT_NEAR(double(zero - row(red)) / double(zero - row(blue)), 2.0, 0.05);
}

TEST(Chart, RefusesWhatCannotBeDrawn) {
    EXPECT_THROW(drawChart({}, {}), RunError);
    EXPECT_THROW(drawChart({{"a", red, {0.0, 1.0}, {0.0, -1.0}}}, {}), RunError);
    EXPECT_THROW(drawChart({{"a", red, {0.0, 1.0}, {0.0, std::numeric_limits<double>::quiet_NaN()}}}, {}), RunError);
}

} // namespace
} // namespace patina
