#include "operators/fields/sun_and_sky.h"

#include "base/errors.h"
#include "operators/fields/sun_position.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

using Imath::V3d;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180.0;

struct SkyType {
    double a, b, c, d, e;
};

/// CIE S 011/E:2003, ISO 15469:2004, table 1.
constexpr std::array<SkyType, 15> skyTypes = {{{4, -0.7, 0, -1, 0},
                                               {4, -0.7, 2, -1.5, 0.15},
                                               {1.1, -0.8, 0, -1, 0},
                                               {1.1, -0.8, 2, -1.5, 0.15},
                                               {0, -1, 0, -1, 0},
                                               {0, -1, 2, -1.5, 0.15},
                                               {0, -1, 5, -2.5, 0.3},
                                               {0, -1, 10, -3, 0.45},
                                               {-1, -0.55, 2, -1.5, 0.15},
                                               {-1, -0.55, 5, -2.5, 0.3},
                                               {-1, -0.55, 10, -3, 0.45},
                                               {-1, -0.32, 10, -3, 0.45},
                                               {-1, -0.32, 16, -3, 0.3},
                                               {-1, -0.15, 16, -3, 0.3},
                                               {-1, -0.15, 24, -2.8, 0.15}}};

bool dependsOnSun(int type) {
    return type < 16 && (skyTypes[type - 1].c != 0.0 || skyTypes[type - 1].e != 0.0);
}

V3d directionOf(const SunPosition& sun) {
    return {std::cos(sun.altitude) * std::sin(sun.azimuth), std::cos(sun.altitude) * std::cos(sun.azimuth),
            std::sin(sun.altitude)};
}

// W/m² on a plane facing the sun.
double directIrradiance(double altitude) {
    const double degrees = altitude / degree;
    const double airMass = 1.0 / (std::sin(altitude) + 0.50572 * std::pow(degrees + 6.07995, -1.6364));
    return 1353.0 * std::pow(0.7, std::pow(airMass, 0.678));
}

// Every fifth day of the span, as Julian days of a common year at noon.
std::vector<double> daysOf(const SunAndSky& light) {
    const double year = julianDayOf(2025, 1, 1.0);
    double first = julianDayOf(2025, light.firstMonth, 1.0) - year;
    double last =
        (light.lastMonth == 12 ? julianDayOf(2026, 1, 1.0) : julianDayOf(2025, light.lastMonth + 1, 1.0)) - year;
    if (last <= first)
        last += 365.0;
    const int count = std::max(1, static_cast<int>(std::lround((last - first) / 5.0)));
    std::vector<double> days;
    for (int i = 0; i < count; ++i)
        days.push_back(year + std::fmod(first + (last - first) * (i + 0.5) / count, 365.0) + 0.5);
    return days;
}

void addSky(LightDome& dome, int type, const V3d& sun, double horizontal) {
    dome.addHemisphere([&](const V3d& d) { return cieSkyRadiance(type, d, sun); }, horizontal);
}

} // namespace

std::optional<int> skyNamed(const std::string& name) {
    if (name == "uniform")
        return uniformSky;
    if (name == "overcast")
        return overcastSky;
    if (name == "clear")
        return clearSky;
    if (name == "intermediate")
        return 7;
    return std::nullopt;
}

const std::vector<std::string>& skyNames() {
    static const std::vector<std::string> names = {"uniform", "overcast", "intermediate", "clear"};
    return names;
}

double cieSkyRadiance(int type, const V3d& direction, const V3d& sun) {
    if (type == overcastSky)
        return (1.0 + 2.0 * direction.z) / 3.0;
    const SkyType& sky = skyTypes[type - 1];
    const auto gradation = [&](double cosine) { return cosine > 1e-4 ? 1.0 + sky.a * std::exp(sky.b / cosine) : 1.0; };
    const auto indicatrix = [&](double cosine) {
        const double c = std::clamp(cosine, -1.0, 1.0);
        return 1.0 + sky.c * (std::exp(sky.d * std::acos(c)) - std::exp(sky.d * 0.5 * pi)) + sky.e * c * c;
    };
    return indicatrix(direction.dot(sun)) * gradation(direction.z) / (indicatrix(sun.z) * gradation(1.0));
}

void SunAndSky::check() const {
    const auto refuse = [](const std::string& message, const std::string& remedy) {
        throw RunError("exposure", message, remedy);
    };
    if (!(latitudeDegrees >= -90.0 && latitudeDegrees <= 90.0))
        refuse(fmt::format("the latitude {:g} is beyond 90 degrees", latitudeDegrees),
               "-90 is the south pole, 90 the north");
    if (firstMonth < 1 || firstMonth > 12 || lastMonth < 1 || lastMonth > 12)
        refuse("months go from 1 to 12", {});
    if (!(firstHour >= 0.0 && lastHour <= 24.0 && firstHour < lastHour))
        refuse("hours go from 0 to 24, the first before the last", {});
    if (!(clouds >= 0.0 && clouds <= 1.0))
        refuse("clouds is a fraction, 0 to 1", {});
    if (sky && (*sky < 1 || *sky > overcastSky))
        refuse(fmt::format("there is no sky of type {}", *sky), "types are 1 to 15 (CIE S 011) and 16, overcast");
}

LightDome makeLightDome(const SunAndSky& light) {
    light.check();
    LightDome dome;
    if (!light.sun && light.sky && !dependsOnSun(*light.sky)) {
        addSky(dome, *light.sky, {0.0, 0.0, 1.0}, 1.0);
        return dome;
    }
    const double latitude = light.latitudeDegrees * degree;
    const auto days = daysOf(light);
    // The sun moves 1.5° in 6 minutes, less than a bin; the sky changes slowly, and is summed in bins of its own time.
    const int moments = std::max(1, static_cast<int>(std::lround((light.lastHour - light.firstHour) * 10.0)));
    const double step = (light.lastHour - light.firstHour) / moments;
    const int overcast = light.sky.value_or(overcastSky), clear = light.sky.value_or(clearSky);
    const double weight = 1.0 / (double(days.size()) * moments);
    double overcastHorizontal = 0.0;
    for (std::size_t day = 0; day < days.size(); ++day) {
        const double declination = sunCoordinates(days[day]).declination;
        V3d skySun(0.0);
        double skyHorizontal = 0.0;
        int inPatch = 0;
        const auto flush = [&] {
            if (inPatch > 0 && skyHorizontal > 0.0)
                addSky(dome, clear, skySun.normalized(), skyHorizontal);
            skySun = V3d(0.0);
            skyHorizontal = 0.0;
            inPatch = 0;
        };
        for (int i = 0; i < moments; ++i) {
            const double hour = light.firstHour + step * (i + 0.5);
            const SunPosition sun = sunAbove(latitude, declination, (hour - 12.0) * 15.0 * degree);
            if (sun.altitude <= 0.0)
                continue;
            const V3d towards = directionOf(sun);
            const double direct = directIrradiance(sun.altitude);
            const double diffuse = 0.1 * direct;
            if (light.sun)
                dome.add(towards, direct * (1.0 - light.clouds) * weight);
            // The sky of every third day stands for its neighbours too.
            if (dependsOnSun(clear)) {
                if (day % 3 == 1 || days.size() < 3) {
                    const double share = days.size() < 3 ? 1.0 : double(days.size()) / double((days.size() + 1) / 3);
                    skySun += towards;
                    skyHorizontal += diffuse * (1.0 - light.clouds) * weight * share;
                    if (++inPatch == 10)
                        flush();
                }
            } else {
                overcastHorizontal += diffuse * (1.0 - light.clouds) * weight;
            }
            overcastHorizontal += 0.25 * (direct * towards.z + diffuse) * light.clouds * weight;
        }
        flush();
    }
    if (!(overcastHorizontal > 0.0))
        return dome;
    if (dependsOnSun(overcast)) // the mean place of the sun is enough for the broad bright patch of a covered sky
        addSky(dome, overcast, V3d(0.0, latitude >= 0.0 ? -0.7 : 0.7, 0.7).normalized(), overcastHorizontal);
    else
        addSky(dome, overcast, {0.0, 0.0, 1.0}, overcastHorizontal);
    return dome;
}

double dailyIrradiation(double latitude, double declination, const V3d& normal) {
    constexpr int moments = 240;
    double sum = 0.0;
    for (int i = 0; i < moments; ++i) {
        const SunPosition sun = sunAbove(latitude, declination, ((i + 0.5) / moments * 24.0 - 12.0) * 15.0 * degree);
        if (sun.altitude > 0.0)
            sum += std::max(0.0, directionOf(sun).dot(normal));
    }
    return sum / moments;
}

} // namespace patina
