#include "operators/fields/exposure.h"

#include "base/errors.h"
#include "field_test_shapes.h"
#include "operators/fields/sun_and_sky.h"
#include "operators/fields/sun_position.h"
#include "surface/ray_scene.h"
#include "volume/interface_mesh.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;

constexpr double degree = M_PI / 180.0;

/// Up is z: positions and directions of the closed forms are the model's.
Compass upright() {
    return Compass::from({0.0, 0.0, 1.0}, {0.0, 1.0, 0.0});
}

LightDome skyDome(int type) {
    SunAndSky light;
    light.sky = type;
    light.sun = false;
    return makeLightDome(light);
}

const Occlusion nothing = [](const V3f&, const V3f&) { return false; };

/// A trench along y, its floor at z = 0, from x = 0 to w, d deep.
Occlusion trench(double w, double d) {
    return [w, d](const V3f& o, const V3f& r) {
        if (r.z <= 0.f)
            return true;
        const double x = o.x + double(r.x) / r.z * (d - o.z);
        return x < 0.0 || x > w;
    };
}

Occlusion well(double radius, double d) {
    return [radius, d](const V3f& o, const V3f& r) {
        if (r.z <= 0.f)
            return true;
        const double s = (d - o.z) / r.z;
        return std::hypot(o.x + r.x * s, o.y + r.y * s) > radius;
    };
}

/// A groove along y, apex at the origin, walls at `half` from the vertical and `length` long.
Occlusion vGroove(double half, double length) {
    const double rim = length * std::cos(half), reach = length * std::sin(half);
    return [rim, reach](const V3f& o, const V3f& r) {
        if (r.z <= 0.f)
            return std::abs(r.z) * reach < std::abs(r.x) * rim ? false : true;
        const double x = o.x + double(r.x) / r.z * (rim - o.z);
        return std::abs(x) > reach;
    };
}

struct Place {
    V3f position, normal;
    Occlusion occluded;
    double truth;
};

double rmsError(const LightDome& dome, const std::vector<Place>& places, double* worst = nullptr) {
    DomeGathering options;
    options.rays = 1024;
    const DomeGatherer gatherer(dome, upright(), options);
    double sum = 0.0;
    int count = 0;
    for (const Place& place : places)
        for (int set = 0; set < DomeGatherer::sets; set += 7, ++count) {
            const double error = gatherer.irradiance(place.position, place.normal, set, place.occluded) - place.truth;
            sum += error * error;
            if (worst)
                *worst = std::max(*worst, std::abs(error));
        }
    return std::sqrt(sum / count);
}

V3f tilted(double degrees, double azimuth = 0.7) {
    const double b = degrees * degree;
    return V3f(V3d(std::sin(b) * std::cos(azimuth), std::sin(b) * std::sin(azimuth), std::cos(b)));
}

TEST(Exposure, UniformSkyMatchesTheClosedForms) {
    std::vector<Place> places;
    for (const double b : {0.0, 20.0, 45.0, 60.0, 90.0, 120.0, 160.0})
        places.push_back({{0, 0, 0},
                          tilted(b),
                          [](const V3f&, const V3f& r) { return r.z <= 0.f; },
                          0.5 * (1.0 + std::cos(b * degree))});
    for (const double d : {0.5, 1.0, 2.0})
        for (const double x : {0.5, 0.25, 0.1})
            places.push_back({V3f(V3d(x, 0, 0)),
                              {0, 0, 1},
                              trench(1.0, d),
                              0.5 * (std::sin(std::atan(x / d)) + std::sin(std::atan((1.0 - x) / d)))});
    for (const double z : {0.2, 0.5, 1.5}) // the wall at x = 0 of a deep trench, z below the rim
        places.push_back(
            {V3f(V3d(1e-4, 0, 4.0 - z)), {1, 0, 0}, trench(1.0, 4.0), 0.5 * (1.0 - z / std::hypot(z, 1.0))});
    for (const double half : {30.0, 45.0, 60.0})
        for (const double s : {0.3, 0.7}) {
            // On the left wall, facing right and up: the opening is seen under the angle between the wall's own rim and
            // the opposite one.
            const double a = half * degree;
            const V3d p(-s * std::sin(a), 0.0, s * std::cos(a)), rim(std::sin(a), 0.0, std::cos(a));
            const V3d own(-std::sin(a), 0.0, std::cos(a)), other = (rim - p).normalized();
            const double truth = 0.5 * (1.0 - own.dot(other));
            const V3d n(std::cos(a), 0.0, std::sin(a));
            places.push_back({V3f(p + n * 1e-5), V3f(n), vGroove(a, 1.0), truth});
        }
    for (const double h : {0.5, 1.0, 2.0})
        places.push_back({{0, 0, 0}, {0, 0, 1}, well(1.0, h), 1.0 / (1.0 + h * h)});
    double worst = 0.0;
    EXPECT_LT(rmsError(skyDome(uniformSky), places, &worst), 0.005);
    EXPECT_LT(worst, 0.03);
}

TEST(Exposure, CieOvercastSkyMatchesTheClosedForms) {
    std::vector<Place> places;
    for (const auto& [b, truth] : {std::pair(0.0, 1.0),
                                   {30.0, 0.903201},
                                   {45.0, 0.797471},
                                   {60.0, 0.669427},
                                   {90.0, 0.396177},
                                   {120.0, 0.169427}})
        places.push_back({{0, 0, 0}, tilted(b), nothing, truth});
    for (const auto& [d, truth] : {std::pair(1.0, 0.505843), {2.0, 0.278659}})
        places.push_back({{0.5f, 0, 0}, {0, 0, 1}, trench(1.0, d), truth});
    EXPECT_LT(rmsError(skyDome(overcastSky), places), 0.005);
}

TEST(Exposure, TheFloorOfAVoxelisedWellSeesItsOpening) {
    // The whole way: level set, surface voxels, triangles, rays. A block with a well of radius 12 and depth 12.
    const double radius = 12.0, depth = 12.0;
    const auto volume = test::volumeOf(
        [=](const V3d& p) {
            const double block = std::max(std::hypot(p.x, p.y) - 28.0, std::max(p.z, -p.z - 24.0));
            return std::max(block, -std::max(std::hypot(p.x, p.y) - radius, -depth - p.z));
        },
        42);
    const SurfaceVoxels surface = findSurfaceVoxels(*volume, 0);
    const SurfaceMesh mesh = interfaceMesh(*volume, 0);
    const RayScene rays(mesh.positions, mesh.triangles);
    Compass compass = Compass::from(test::toLattice({0, 0, 1}), test::toLattice({0, 1, 0}));
    Progress progress;
    const auto values = gatherDome(surface, 1.0, skyDome(uniformSky), compass, Obstacles::of(rays), {}, progress);
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const V3d p = test::toObject(V3d(surface.feet[i]));
        const double r = std::hypot(p.x, p.y);
        if (std::abs(p.z + depth) > 0.2 || r > radius - 1.5)
            continue;
        // A disc seen from below, off its axis.
        const double a = depth * depth + radius * radius + r * r;
        const double truth =
            0.5 * (1.0 - (a - 2.0 * radius * radius) / std::sqrt(a * a - 4.0 * radius * radius * r * r));
        const double error = values[i] - truth;
        sum += error;
        squares += error * error;
        ++count;
    }
    ASSERT_GT(count, 200);
    const double mean = sum / count;
    // The voxelised rim is rounded, as if the well were a little less deep.
    EXPECT_GT(mean, -0.002);
    EXPECT_LT(mean, 0.02);
    EXPECT_LT(std::sqrt(squares / count - mean * mean), 0.008); // grain
}

TEST(Exposure, GroundLightensWhatLooksDownAndIsShadowedByTheModel) {
    DomeGathering options;
    options.ground = true;
    const DomeGatherer gatherer(skyDome(uniformSky), upright(), options);
    // A vertical wall sees half the sky and half of a ground of albedo 0.2.
    EXPECT_NEAR(gatherer.irradiance({0, 0, 5}, {1, 0, 0}, 3, nothing), 0.5 + 0.5 * 0.2, 0.02);
    EXPECT_NEAR(gatherer.irradiance({0, 0, 5}, {0, 0, -1}, 3, nothing), 0.2, 0.02);
    // Under a roof that hides the sky from the ground it is dark.
    EXPECT_EQ(gatherer.irradiance({0, 0, 5}, {0, 0, -1}, 3, [](const V3f&, const V3f& r) { return r.z > 0.f; }), 0.0);
}

TEST(Exposure, OverTheYearTheEquatorwardSideGetsMoreAndThePolarSideLess) {
    const LightDome dome = makeLightDome({});
    const double north = dome.irradiance({0, 1, 0}), south = dome.irradiance({0, -1, 0}),
                 east = dome.irradiance({1, 0, 0});
    EXPECT_GT(south, 1.5 * north);
    EXPECT_GT(east, north);
    EXPECT_NEAR(east, dome.irradiance({-1, 0, 0}), 0.02 * east);
    SunAndSky down;
    down.latitudeDegrees = -45.0;
    EXPECT_GT(makeLightDome(down).irradiance({0, 1, 0}), 1.5 * makeLightDome(down).irradiance({0, -1, 0}));
    SunAndSky night;
    night.lastHour = 2.0;
    EXPECT_THROW(makeLightDome(night).directions(16, 1), RunError);
}

TEST(Sky, TypesAreThoseOfTheStandard) {
    const std::filesystem::path file =
        std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/sky/cie_general_sky.csv";
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no table at " << file;
    std::ifstream in(file);
    int seen = 0;
    for (std::string line; std::getline(in, line);) {
        std::istringstream row(line);
        double type, a, b, c, d, e;
        char comma;
        if (!(row >> type >> comma >> a >> comma >> b >> comma >> c >> comma >> d >> comma >> e))
            continue;
        ++seen;
        const V3d sun(std::cos(0.6), 0.0, std::sin(0.6));
        for (const V3d& v : {V3d(0, 0, 1), V3d(0.6, 0, 0.8), V3d(-0.3, 0.8, 0.52).normalized()}) {
            const auto phi = [&](double z) { return 1.0 + a * std::exp(b / z); };
            const auto f = [&](double x) {
                return 1.0 + c * (std::exp(d * x) - std::exp(d * M_PI / 2.0)) + e * std::pow(std::cos(x), 2);
            };
            const double truth = f(std::acos(v.dot(sun))) * phi(v.z) / (f(std::acos(sun.z)) * phi(1.0));
            EXPECT_NEAR(cieSkyRadiance(int(type), v, sun), truth, 1e-9 * truth) << type;
        }
    }
    EXPECT_EQ(seen, 15);
}

TEST(Sun, StandsWherePublishedExamplesSay) {
    // Reda and Andreas, "Solar position algorithm" (NREL/TP-560-34302), their worked example: 17 October 2003,
    // 12:30:30 at UTC - 7 h, zenith 50.11162°, azimuth 194.34024°.
    const double day = julianDayOf(2003, 10, 17.0 + (19.0 + 30.0 / 60.0 + 30.0 / 3600.0) / 24.0);
    const SunPosition sun = sunPosition(day, 39.742476 * degree, -105.1786 * degree);
    EXPECT_NEAR(sun.altitude / degree, 90.0 - 50.11162, 0.1);
    EXPECT_NEAR(sun.azimuth / degree, 194.34024, 0.1);
    // Meeus, "Astronomical algorithms", example 25.a: 13 October 1992, 0 h.
    const SunCoordinates place = sunCoordinates(2448908.5);
    EXPECT_NEAR(place.declination / degree, -7.78507, 0.02);
    EXPECT_NEAR(place.rightAscension / degree + 360.0, 198.38083, 0.02);
    EXPECT_EQ(julianDayOf(2000, 1, 1.5), 2451545.0);
}

// Geometry alone: at noon the sun stands 90° - |latitude - declination| high, at the equinox it rises due east, and
// south of the tropics it is north at noon.
TEST(Sun, StandsNorthAtNoonInTheSouth) {
    const double solstice = 23.44 * degree;
    for (const double latitude : {-33.87, -51.0, -66.0}) {
        const SunPosition noon = sunAbove(latitude * degree, solstice, 0.0);
        EXPECT_NEAR(noon.altitude / degree, 90.0 - (23.44 - latitude), 1e-6) << latitude;
        EXPECT_NEAR(std::cos(noon.azimuth), 1.0, 1e-9) << latitude;
        const SunPosition sunrise = sunAbove(latitude * degree, 0.0, -0.5 * M_PI);
        EXPECT_NEAR(sunrise.altitude, 0.0, 1e-9);
        EXPECT_NEAR(sunrise.azimuth / degree, 90.0, 1e-6);
        // Mirror images: what is south there is north here, half a year apart.
        for (const double hour : {-70.0, -20.0, 35.0}) {
            const SunPosition south = sunAbove(latitude * degree, solstice, hour * degree);
            const SunPosition north = sunAbove(-latitude * degree, -solstice, hour * degree);
            EXPECT_NEAR(south.altitude, north.altitude, 1e-12);
            EXPECT_NEAR(std::cos(south.azimuth), -std::cos(north.azimuth), 1e-12);
            EXPECT_NEAR(std::sin(south.azimuth), std::sin(north.azimuth), 1e-12);
        }
    }
    // On a whole sphere: dailyIrradiation() of the mirrored plane and season.
    for (const double tilt : {20.0, 70.0}) {
        const V3d toNorth(0.0, std::sin(tilt * degree), std::cos(tilt * degree));
        EXPECT_NEAR(dailyIrradiation(-40.0 * degree, -15.0 * degree, toNorth),
                    dailyIrradiation(40.0 * degree, 15.0 * degree, {0.0, -toNorth.y, toNorth.z}), 1e-9);
    }
}

// Equinoxes and solstices as the U.S. Naval Observatory publishes them (universal time, to the minute): there the
// longitude of the sun is a multiple of 90°, so its declination is 0 or the obliquity and its right ascension 0, 6, 12
// or 18 hours. The sun moves 0.04° an hour.
TEST(Sun, IsAtTheEquinoxesAndSolsticesThatAreInTheAlmanac) {
    struct Row {
        int year, month;
        double day, hour, minute, declination, rightAscension;
    };
    for (const Row& row : {Row{2000, 3, 20, 7, 35, 0.0, 0.0}, Row{2000, 6, 21, 1, 48, 23.439, 90.0},
                           Row{2000, 9, 22, 17, 28, 0.0, 180.0}, Row{2000, 12, 21, 13, 37, -23.439, 270.0},
                           Row{2020, 3, 20, 3, 50, 0.0, 0.0}, Row{2020, 6, 20, 21, 44, 23.437, 90.0},
                           Row{2020, 9, 22, 13, 31, 0.0, 180.0}, Row{2020, 12, 21, 10, 2, -23.437, 270.0}}) {
        const SunCoordinates sun =
            sunCoordinates(julianDayOf(row.year, row.month, row.day + (row.hour + row.minute / 60.0) / 24.0));
        EXPECT_NEAR(sun.declination / degree, row.declination, 0.02) << row.year << ' ' << row.month;
        const double away = std::remainder(sun.rightAscension / degree - row.rightAscension, 360.0);
        EXPECT_NEAR(away, 0.0, 0.02) << row.year << ' ' << row.month;
    }
}

TEST(Sun, DailyIrradiationOfTiltedPlanesMatchesTheClosedForm) {
    for (const double latitude : {0.0, 30.0, 52.0})
        for (const double declination : {-23.0, 0.0, 15.0, 23.0})
            for (const double tilt : {0.0, 30.0, 60.0}) {
                const double phi = latitude * degree, delta = declination * degree,
                             lowered = (latitude - tilt) * degree;
                const auto sunset = [&](double l) {
                    return std::acos(std::clamp(-std::tan(l) * std::tan(delta), -1.0, 1.0));
                };
                const double w = std::min(sunset(phi), sunset(lowered));
                const double truth =
                    (std::cos(lowered) * std::cos(delta) * std::sin(w) + w * std::sin(lowered) * std::sin(delta)) /
                    M_PI;
                const V3d normal(0.0, -std::sin(tilt * degree), std::cos(tilt * degree));
                EXPECT_NEAR(dailyIrradiation(phi, delta, normal), truth, 0.01 * truth + 1e-4)
                    << latitude << ' ' << declination << ' ' << tilt;
                // Binned into the dome as well.
                LightDome dome;
                for (int i = 0; i < 240; ++i) {
                    const SunPosition sun = sunAbove(phi, delta, ((i + 0.5) / 10.0 - 12.0) * 15.0 * degree);
                    if (sun.altitude > 0.0)
                        dome.add({std::cos(sun.altitude) * std::sin(sun.azimuth),
                                  std::cos(sun.altitude) * std::cos(sun.azimuth), std::sin(sun.altitude)},
                                 1.0 / 240.0);
                }
                EXPECT_NEAR(dome.irradiance(normal), truth, 0.01 * std::max(truth, 0.1))
                    << latitude << ' ' << declination << ' ' << tilt;
            }
}

TEST(Sun, ValuesOutOfRangeAreRefused) {
    SunAndSky light;
    light.latitudeDegrees = 91.0;
    EXPECT_THROW(makeLightDome(light), RunError);
    light = {};
    light.sky = 17;
    EXPECT_THROW(makeLightDome(light), RunError);
    EXPECT_THROW(Compass::from({0, 0, 0}, {0, 0, 1}), RunError);
    EXPECT_THROW(Compass::from({0, 1, 0}, {0, 2, 0}), RunError);
}

} // namespace
} // namespace patina
