#pragma once
// The light of sun and sky over a span of time, as one distribution over directions.

#include "operators/fields/light_dome.h"

#include <optional>
#include <string>
#include <vector>

namespace patina {

/// A sky of CIE S 011 / ISO 15469: 1 … 15, and 16, the traditional overcast sky L = Lz (1 + 2 sin γ) / 3.
constexpr int overcastSky = 16, uniformSky = 5, clearSky = 12;

/// "uniform", "overcast", "clear", "intermediate" (type 7); nothing for another name.
std::optional<int> skyNamed(const std::string& name);
const std::vector<std::string>& skyNames();

/// Radiance of a sky over that of its zenith: L / Lz = f(χ) φ(Z) / (f(Zs) φ(0)), φ(Z) = 1 + a exp(b / cos Z),
/// f(χ) = 1 + c (exp(dχ) - exp(dπ/2)) + e cos²χ.
/// \param direction, sun  unit, as (east, north, up); the direction must look up
double cieSkyRadiance(int type, const Imath::V3d& direction, const Imath::V3d& sun);

/// What light there is.
struct SunAndSky {
    std::optional<int> sky;        ///< type of the diffuse light; not set: clear and overcast days, see `clouds`
    bool sun = true;               ///< direct light of the sun
    double latitudeDegrees = 45.0; ///< -90 … 90, positive north
    int firstMonth = 1;            ///< 1 … 12
    int lastMonth = 12;            ///< … to the end of this one; before the first: over the turn of the year
    double firstHour = 0.0;        ///< solar time, 0 … 24
    double lastHour = 24.0;
    double clouds = 0.5; ///< fraction of the time that is overcast

    /// \throws RunError where a value is out of range
    void check() const;
};

/// The sum over the span. Irradiances are relative. On clear days the sun's is 1353 W/m² · 0.7^(m^0.678) (Meinel and
/// Meinel, "Applied solar energy", 1976) with the air mass m of Kasten and Young (Applied Optics 28, 1989), and the sky
/// adds a tenth of it to the horizontal; on overcast days a quarter of the clear day's global irradiance arrives from
/// the sky alone (Kasten and Czeplak, Solar Energy 24, 1980). Without sun, a sky that does not depend on the sun's
/// place is taken as it is, once.
LightDome makeLightDome(const SunAndSky& light);

/// Irradiation of a plane by a sun without atmosphere over one day, in units of the solar constant times a day:
/// the part of makeLightDome() that has a closed form.
/// \param normal  as (east, north, up)
double dailyIrradiation(double latitude, double declination, const Imath::V3d& normal);

} // namespace patina
