#include "operators/fields/sun_position.h"

#include <cmath>

namespace patina {

namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;
constexpr double fullTurn = 360.0 * degree;

} // namespace

double julianDayOf(int year, int month, double day) {
    if (month <= 2) { // January and February count as months 13 and 14 of the year before
        --year;
        month += 12;
    }
    const int century = year / 100;
    return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + day + 2 - century + century / 4 -
           1524.5;
}

SunCoordinates sunCoordinates(double julianDay) {
    const double n = julianDay - 2451545.0;
    const double meanLongitude = 280.460 + 0.9856474 * n;
    const double anomaly = (357.528 + 0.9856003 * n) * degree;
    const double longitude = (meanLongitude + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2.0 * anomaly)) * degree;
    const double obliquity = (23.439 - 4e-7 * n) * degree;
    return {std::asin(std::sin(obliquity) * std::sin(longitude)),
            std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude))};
}

SunPosition sunAbove(double latitude, double declination, double hourAngle) {
    // The direction to the sun as east, north, up.
    const double up =
        std::sin(latitude) * std::sin(declination) + std::cos(latitude) * std::cos(declination) * std::cos(hourAngle);
    const double north =
        std::cos(latitude) * std::sin(declination) - std::sin(latitude) * std::cos(declination) * std::cos(hourAngle);
    const double east = -std::cos(declination) * std::sin(hourAngle);
    double azimuth = std::atan2(east, north);
    if (azimuth < 0.0)
        azimuth += fullTurn;
    return {std::asin(std::fmin(1.0, std::fmax(-1.0, up))), azimuth};
}

SunPosition sunPosition(double julianDay, double latitude, double longitude) {
    const SunCoordinates sun = sunCoordinates(julianDay);
    // Greenwich mean sidereal time (Astronomical Almanac), as an angle.
    const double sidereal = std::fmod(280.46061837 + 360.98564736629 * (julianDay - 2451545.0), 360.0) * degree;
    return sunAbove(latitude, sun.declination, sidereal + longitude - sun.rightAscension);
}

} // namespace patina
