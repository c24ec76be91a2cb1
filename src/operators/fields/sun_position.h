#pragma once
// Where the sun stands.

namespace patina {

/// Radians. Azimuth from north over east.
struct SunPosition {
    double altitude = 0.0; ///< above the horizon, without refraction
    double azimuth = 0.0;
};

/// The sun's apparent declination and right ascension, radians.
struct SunCoordinates {
    double declination = 0.0;
    double rightAscension = 0.0;
};

/// The low-precision formulas of the Astronomical Almanac: good to 0.01° from 1950 to 2050.
/// \param julianDay  universal time; 2451545.0 is noon of 1 January 2000
SunCoordinates sunCoordinates(double julianDay);

/// \param hourAngle  radians, 0 at noon, positive in the afternoon
SunPosition sunAbove(double latitude, double declination, double hourAngle);

/// For a place on Earth, radians, longitude positive to the east.
SunPosition sunPosition(double julianDay, double latitude, double longitude);

/// Julian day of a date at 0 h universal time (Gregorian calendar). \param day  may have a fraction
double julianDayOf(int year, int month, double day);

} // namespace patina
