// The same code that grows on objects, on flat periodic lattices, against the statistical physics of surface growth.

#include "operators/growth/grow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace patina {
namespace {

GrowthOptions aged(GrowthModel model, double age) {
    GrowthOptions options;
    options.model = model;
    options.step = options.total = age;
    return options;
}

double variance(const GrowthLattice& lattice, const std::vector<float>& height) {
    const double width = measureHeights(lattice, height).interfaceWidth;
    return width * width;
}

/// Least-squares slope of y over x.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
    double mx = 0, my = 0, xy = 0, xx = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mx += x[i] / double(x.size());
        my += y[i] / double(x.size());
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        xy += (x[i] - mx) * (y[i] - my);
        xx += (x[i] - mx) * (x[i] - mx);
    }
    return xy / xx;
}

/// beta from W² ~ t^(2 beta).
double exponent(const std::vector<double>& times, const std::vector<double>& squares) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < times.size(); ++i) {
        x.push_back(std::log(times[i]));
        y.push_back(0.5 * std::log(squares[i]));
    }
    return slope(x, y);
}

TEST(RandomDeposition, widthGrowsAsTheRootOfTime) {
    const GrowthLattice line = flatLattice(65536, 1, true);
    std::vector<double> times, squares;
    for (double t = 1; t <= 256; t *= 2) {
        times.push_back(t);
        squares.push_back(variance(line, growHeights(line, aged(GrowthModel::randomDeposition, t), 1, "RD")));
    }
    EXPECT_NEAR(exponent(times, squares), 0.5, 0.005);
    const GrowthLattice plane = flatLattice(512, 512, true);
    const auto height = growHeights(plane, aged(GrowthModel::randomDeposition, 64), 1, "RD");
    EXPECT_NEAR(variance(plane, height) / 64.0, 1.0, 0.01);
    // Heights are Poisson numbers: skewness t^-1/2, mean t.
    EXPECT_NEAR(measureHeights(plane, height).skewness, 0.125, 0.02);
    EXPECT_NEAR(measureHeights(plane, height).mean, 64.0, 0.1);
}

TEST(Relaxation, widthGrowsAsTheFourthRootOfTimeOnALine) {
    const GrowthLattice line = flatLattice(32768, 1, true);
    std::vector<double> times, squares;
    for (double t = 4; t <= 256; t *= 2) {
        times.push_back(t);
        squares.push_back(variance(line, growHeights(line, aged(GrowthModel::relaxation, t), 1, "RDR")));
    }
    RecordProperty("beta", std::to_string(exponent(times, squares)));
    EXPECT_NEAR(exponent(times, squares), 0.25, 0.02);
}

TEST(Relaxation, squaredWidthGrowsAsTheLogarithmOfTimeOnAPlane) {
    const GrowthLattice plane = flatLattice(256, 256, true);
    std::vector<double> logs, squares;
    for (double t = 4; t <= 256; t *= 4) {
        logs.push_back(std::log(t));
        squares.push_back(variance(plane, growHeights(plane, aged(GrowthModel::relaxation, t), 1, "RDR")));
    }
    RecordProperty("slope", std::to_string(slope(logs, squares)));
    EXPECT_NEAR(slope(logs, squares), 0.058, 0.004);
    const double late = std::log(squares[3] / squares[2]) / (2.0 * std::log(4.0)); // 64 … 256
    EXPECT_LT(late, 0.08);                                                         // no power law
}

TEST(Relaxation, aLongerReachIsSmoother) {
    const GrowthLattice plane = flatLattice(128, 128, true);
    GrowthOptions options = aged(GrowthModel::relaxation, 16);
    double last = 1e9;
    for (const int reach : {1, 2, 4}) {
        options.reach = reach;
        const auto height = growHeights(plane, options, 1, "RDR");
        EXPECT_LT(variance(plane, height), last);
        EXPECT_NEAR(measureHeights(plane, height).mean, 16.0, 0.15); // no particle is lost
        last = variance(plane, height);
    }
}

/// What ballistic deposition looks like at a few times. Its raw width hides the exponent behind the scatter of single
/// deposits (the "intrinsic width"): Alves, Oliveira and Ferreira subtract the variance of the height that one deposit
/// adds, which is read here from the cells that change within a fiftieth of a monolayer.
struct BallisticRecord {
    std::vector<double> times, means, squares, corrected;
};

BallisticRecord ballisticRecord(const GrowthLattice& lattice, double first, double last) {
    BallisticRecord record;
    for (double t = first; t <= last; t *= 2) {
        const auto height = growHeights(lattice, aged(GrowthModel::ballisticDeposition, t), 1, "BD");
        const auto later = growHeights(lattice, aged(GrowthModel::ballisticDeposition, t + 0.02), 1, "BD");
        double n = 0, sum = 0, second = 0;
        for (std::size_t i = 0; i < height.size(); ++i) {
            const double d = double(later[i]) - height[i];
            if (d > 0.0) {
                n += 1.0;
                sum += d;
                second += d * d;
            }
        }
        const double ofDeposits = second / n - sum / n * (sum / n);
        record.times.push_back(t);
        record.means.push_back(measureHeights(lattice, height).mean);
        record.squares.push_back(variance(lattice, height));
        record.corrected.push_back(record.squares.back() - ofDeposits);
    }
    return record;
}

TEST(BallisticDeposition, onALineObeysKardarParisiZhang) {
    const BallisticRecord record = ballisticRecord(flatLattice(32768, 1, true), 16, 256);
    const double beta = exponent(record.times, record.corrected);
    RecordProperty("beta", std::to_string(beta));
    EXPECT_NEAR(beta, 1.0 / 3.0, 0.03);
    const double velocity = (record.means[4] - record.means[3]) / 128.0;
    RecordProperty("density", std::to_string(1.0 / velocity));
    EXPECT_NEAR(1.0 / velocity, 0.470, 0.002); // density of the deposit at t of about 190
}

TEST(BallisticDeposition, onAPlaneHasTheKnownExponentVelocityAndDensity) {
    const BallisticRecord record = ballisticRecord(flatLattice(400, 400, true), 8, 128);
    RecordProperty("beta", std::to_string(exponent(record.times, record.corrected)));
    EXPECT_NEAR(exponent(record.times, record.corrected), 0.241, 0.06);
    // h = v t + A t^beta: two differences give v. The sticking rule is what it detects: another neighbourhood is 15 to
    // 60 per cent off.
    const double beta = 0.2414, a = record.means[3] - record.means[2], b = record.means[4] - record.means[3];
    const double p = std::pow(64.0, beta) - std::pow(32.0, beta), q = std::pow(128.0, beta) - std::pow(64.0, beta);
    const double velocity = (b * p - a * q) / (64.0 * p - 32.0 * q);
    RecordProperty("velocity", std::to_string(velocity));
    EXPECT_NEAR(velocity, 3.334, 0.03);
    EXPECT_NEAR(1.0 / velocity, 0.300, 0.003);
}

TEST(BallisticDeposition, densityIsThatOfItsParticles) {
    const GrowthLattice plane = flatLattice(256, 256, true);
    const GrowthStatistics s = grow(plane, aged(GrowthModel::ballisticDeposition, 30), 1, "BD").statistics;
    EXPECT_NEAR(double(s.particles) / double(plane.size()), 30.0, 0.1);
    EXPECT_NEAR(s.density, 30.0 / s.mean, 0.002);
    EXPECT_GT(s.density, 0.30); // nearer the metal it is higher than in the bulk
}

} // namespace
} // namespace patina
