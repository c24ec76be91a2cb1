#include "operators/fields/light_dome.h"

#include "base/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace patina {

using Imath::V3d;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Sobol's sequence, dimensions 1 and 2: a (0, 2)-sequence in base 2.
std::array<double, 2> sobol(std::uint32_t index) {
    std::uint32_t first = 0, second = 0;
    std::uint32_t v = 1u << 31;
    for (std::uint32_t bit = 0, rest = index; rest != 0; ++bit, rest >>= 1, v ^= v >> 1) {
        if ((rest & 1u) == 0)
            continue;
        first ^= 1u << (31 - bit);
        second ^= v;
    }
    return {(first + 0.5) / 4294967296.0, (second + 0.5) / 4294967296.0};
}

double sineOfEdge(int row, int rows) {
    return std::sin((-0.5 + double(row) / rows) * pi);
}

} // namespace

Compass Compass::from(const V3d& up, const V3d& north) {
    if (!(up.length() > 0.0))
        throw RunError("exposure", "the model has no up axis", "give it by --up");
    Compass compass;
    compass.up = up.normalized();
    const V3d level = north - compass.up * north.dot(compass.up);
    if (!(level.length() > 1e-6 * north.length()) || !(north.length() > 0.0))
        throw RunError("exposure", "north lies along the model's up axis", "give a direction that is level");
    compass.north = level.normalized();
    return compass;
}

V3d Compass::usualNorth(const V3d& up) {
    return std::abs(up.z) > std::abs(up.y) ? V3d(0.0, 1.0, 0.0) : V3d(0.0, 0.0, -1.0);
}

V3d Compass::direction(const V3d& eastNorthUp) const {
    return east() * eastNorthUp.x + north * eastNorthUp.y + up * eastNorthUp.z;
}

LightDome::LightDome() : bins_(rows * columns, 0.0) {}

const std::vector<V3d>& LightDome::centres() {
    static const std::vector<V3d> all = [] {
        std::vector<V3d> directions;
        for (int row = 0; row < rows; ++row) {
            // The mean height of the bin's area, not of its angle.
            const double z = 0.5 * (sineOfEdge(row, rows) + sineOfEdge(row + 1, rows)), r = std::sqrt(1.0 - z * z);
            for (int column = 0; column < columns; ++column) {
                const double azimuth = (column + 0.5) * 2.0 * pi / columns;
                directions.emplace_back(r * std::sin(azimuth), r * std::cos(azimuth), z);
            }
        }
        return directions;
    }();
    return all;
}

double LightDome::solidAngle(int row) {
    return (sineOfEdge(row + 1, rows) - sineOfEdge(row, rows)) * 2.0 * pi / columns;
}

void LightDome::add(const V3d& direction, double irradiance) {
    const V3d d = direction.normalized();
    double azimuth = std::atan2(d.x, d.y);
    if (azimuth < 0.0)
        azimuth += 2.0 * pi;
    const int row =
        std::clamp(static_cast<int>((std::asin(std::clamp(d.z, -1.0, 1.0)) / pi + 0.5) * rows), 0, rows - 1);
    const int column = std::min(static_cast<int>(azimuth / (2.0 * pi) * columns), columns - 1);
    bins_[row * columns + column] += irradiance;
}

void LightDome::addHemisphere(const std::function<double(const V3d&)>& radiance, double horizontal, bool upper) {
    std::vector<double> part(bins_.size(), 0.0);
    double sum = 0.0;
    for (int row = upper ? rows / 2 : 0; row < (upper ? rows : rows / 2); ++row)
        for (int column = 0; column < columns; ++column) {
            const V3d& d = centres()[row * columns + column];
            const double value = std::max(0.0, radiance(d)) * solidAngle(row);
            part[row * columns + column] = value;
            sum += value * std::abs(d.z);
        }
    if (!(sum > 0.0))
        return;
    for (std::size_t i = 0; i < bins_.size(); ++i)
        bins_[i] += part[i] * (horizontal / sum);
}

void LightDome::add(const LightDome& other, double factor) {
    for (std::size_t i = 0; i < bins_.size(); ++i)
        bins_[i] += other.bins_[i] * factor;
}

double LightDome::irradiance(const V3d& normal) const {
    const std::vector<V3d>& directions = centres();
    double sum = 0.0;
    for (std::size_t i = 0; i < bins_.size(); ++i)
        sum += bins_[i] * std::max(0.0, directions[i].dot(normal));
    return sum;
}

double LightDome::largestIrradiance() const {
    // It is a smooth function of the normal, flat at its largest: 5° apart is close enough (1 - cos 2.5° = 0.001).
    double largest = irradiance({0.0, 0.0, 1.0});
    for (int row = 1; row < 36; ++row)
        for (int column = 0; column < 72; ++column) {
            const double altitude = (-90.0 + row * 5.0) * pi / 180.0, azimuth = column * 5.0 * pi / 180.0;
            largest = std::max(largest, irradiance({std::cos(altitude) * std::sin(azimuth),
                                                    std::cos(altitude) * std::cos(azimuth), std::sin(altitude)}));
        }
    return largest;
}

double LightDome::total() const {
    double sum = 0.0;
    for (const double bin : bins_)
        sum += bin;
    return sum;
}

std::vector<V3d> LightDome::directions(int count, int sets) const {
    std::vector<double> rowEnd(rows), columnEnd(bins_.size());
    double all = 0.0;
    for (int row = 0; row < rows; ++row) {
        double inRow = 0.0;
        for (int column = 0; column < columns; ++column)
            columnEnd[row * columns + column] = inRow += bins_[row * columns + column];
        rowEnd[row] = all += inRow;
    }
    if (!(all > 0.0))
        throw RunError("exposure", "no light at all falls in the span of time asked for",
                       "choose months and hours in which the sun is up");

    std::vector<V3d> directions(std::size_t(count) * sets);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const auto [u, v] = sobol(static_cast<std::uint32_t>(i));
        const auto pick = [](const double* ends, int n, double at, double& within) {
            const int k = std::min(static_cast<int>(std::upper_bound(ends, ends + n, at) - ends), n - 1);
            const double low = k > 0 ? ends[k - 1] : 0.0;
            within = ends[k] > low ? std::clamp((at - low) / (ends[k] - low), 0.0, 1.0) : 0.5;
            return k;
        };
        double inRow, inColumn;
        const int row = pick(rowEnd.data(), rows, v * all, inRow);
        const double* ends = &columnEnd[std::size_t(row) * columns];
        const int column = pick(ends, columns, u * ends[columns - 1], inColumn);
        const double low = sineOfEdge(row, rows), high = sineOfEdge(row + 1, rows);
        const double z = low + (high - low) * inRow, r = std::sqrt(std::max(0.0, 1.0 - z * z));
        const double azimuth = (column + inColumn) * 2.0 * pi / columns;
        directions[i] = {r * std::sin(azimuth), r * std::cos(azimuth), z};
    }
    return directions;
}

} // namespace patina
