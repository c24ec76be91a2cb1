// Exposure from end to end, from a mesh to the field in the volume: level set, surface voxels, Embree, 1024 directions,
// smoothing; against closed forms (Howell's catalogue of view factors; Moon and Spencer's overcast sky). The shapes are
// turned so that no face lies along the lattice, and their creases are a dozen or two voxels wide.

#include "faceted_models.h"
#include "operators/fields/field_store.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;

constexpr double degree = M_PI / 180.0;

struct Exposed {
    std::unique_ptr<test::Piece> piece;
    ThicknessMapPtr map;

    /// \param up  in object coordinates
    Exposed(const SurfaceMesh& mesh, int sky, const V3d& up = {0, 0, 1})
        : piece(test::makePiece(mesh, test::voxelScale())) {
        FieldStore::Scene scene;
        scene.volume = piece->volume.get();
        scene.binding = piece->binding.get();
        scene.up = test::toLattice(up);
        ExposureRequest request;
        request.light.sky = sky;
        request.light.sun = false;
        request.rays = 1024;
        request.north = test::toLattice(std::abs(up.y) < 0.9 ? V3d(0, 1, 0) : V3d(1, 0, 0));
        Progress progress;
        map = FieldStore(scene).exposure(request, progress);
    }
    /// \param n  in object coordinates
    double at(const V3d& p, const V3d& n) const {
        MapPoint point;
        point.normal = test::toLattice(n);
        point.position = test::toLattice(p);
        return map->value(point);
    }
};

/// Rms and mean of (field - truth) over points of a case.
struct Errors {
    double squares = 0.0, sum = 0.0, worst = 0.0;
    int count = 0;
    void add(double error) {
        squares += error * error;
        sum += error;
        worst = std::max(worst, std::abs(error));
        ++count;
    }
    double rms() const { return std::sqrt(squares / count); }
    double mean() const { return sum / count; }
};
std::ostream& operator<<(std::ostream& out, const Errors& e) {
    return out << "rms " << e.rms() << ", mean " << e.mean() << ", worst " << e.worst << " of " << e.count;
}

// A floor's middle up to two voxels from its walls.
template <typename Visit>
void acrossFloor(double half, Visit&& visit) {
    for (double x = -half + 2.0; x <= half - 2.0; x += 0.5)
        for (double y = -6.0; y <= 6.0; y += 1.3)
            visit(x, y);
}

const std::vector<std::pair<int, const char*>> skies = {{uniformSky, "uniform"}, {overcastSky, "overcast"}};

TEST(ExposureTruths, TiltedPlanes) {
    const SurfaceMesh plate = test::prism({{-14, 0, -4}, {14, 0, -4}, {14, 0, 0}, {-14, 0, 0}}, {{0, 1, 2, 3}}, 28.0);
    for (const auto& [sky, name] : skies)
        for (const double b : {0.0, 30.0, 45.0, 60.0, 90.0, 120.0}) {
            const double a = b * degree, s = std::sin(0.5 * a);
            const double truth =
                sky == uniformSky ? 0.5 * (1.0 + std::cos(a))
                                  : 1.0 - s * s + 4.0 / (7.0 * M_PI) * (std::sin(a) - a * std::cos(a) - M_PI * s * s);
            const Exposed exposed(plate, sky, {0.6 * std::sin(a), 0.8 * std::sin(a), std::cos(a)});
            Errors errors;
            acrossFloor(14.0, [&](double x, double y) { errors.add(exposed.at({x, y, 0.0}, {0, 0, 1}) - truth); });
            EXPECT_LT(errors.rms(), 0.005) << name << ", " << b << " degrees: " << errors;
        }
}

TEST(ExposureTruths, TrenchFloorAndWalls) {
    const double w = 16.0;
    for (const auto& [sky, name] : skies)
        for (const double d : {8.0, 16.0, 32.0}) {
            const SurfaceMesh mesh = test::prism({{-13, 0, -d - 4},
                                                  {13, 0, -d - 4},
                                                  {13, 0, 0},
                                                  {0.5 * w, 0, 0},
                                                  {0.5 * w, 0, -d},
                                                  {-0.5 * w, 0, -d},
                                                  {-0.5 * w, 0, 0},
                                                  {-13, 0, 0}},
                                                 {{0, 5, 6, 7}, {0, 1, 4, 5}, {1, 2, 3, 4}}, 240.0);
            const Exposed exposed(mesh, sky);
            const bool isOvercast = sky == overcastSky;
            Errors floor, wall;
            double sum = 0.0;
            int count = 0;
            acrossFloor(0.5 * w, [&](double x, double y) {
                const double low = std::atan((x + 0.5 * w) / d), high = std::atan((0.5 * w - x) / d);
                double truth = 0.5 * (std::sin(low) + std::sin(high));
                if (isOvercast) {
                    const auto f = [](double t) {
                        return 0.5 * M_PI * std::sin(t) + 4.0 / 3.0 * t + 2.0 / 3.0 * std::sin(2.0 * t);
                    };
                    truth = 3.0 / (7.0 * M_PI) * (f(high) + f(low));
                }
                floor.add(exposed.at({x, y, -d}, {0, 0, 1}) - truth);
            });
            EXPECT_LT(floor.rms(), 0.005) << name << ", depth " << d << ": " << floor;
            if (isOvercast)
                continue;
            for (double z = 0.5; z <= d - 0.5; z += 0.5)
                for (double y = -6.0; y <= 6.0; y += 1.3)
                    wall.add(exposed.at({-0.5 * w, y, -z}, {1, 0, 0}) - 0.5 * (1.0 - z / std::hypot(z, w)));
            EXPECT_LT(wall.rms(), 0.005) << name << ", wall, depth " << d << ": " << wall;
            // The floor's average, its strips beside the walls included.
            for (double x = -0.5 * w + 0.25; x < 0.5 * w; x += 0.25)
                for (double y = -6.0; y <= 6.0; y += 1.3, ++count)
                    sum += exposed.at({x, y, -d}, {0, 0, 1});
            EXPECT_NEAR(sum / count, std::hypot(1.0, d / w) - d / w, 0.005) << "floor average, depth " << d;
        }
}

TEST(ExposureTruths, WallsOfAGroove) {
    const double length = 30.0;
    for (const double half : {30.0, 45.0, 60.0}) {
        const double a = half * degree, reach = length * std::sin(a), deep = length * std::cos(a);
        const SurfaceMesh mesh = test::prism({{-reach - 6, 0, -deep - 5},
                                              {reach + 6, 0, -deep - 5},
                                              {reach + 6, 0, 0},
                                              {reach, 0, 0},
                                              {0, 0, -deep},
                                              {-reach, 0, 0},
                                              {-reach - 6, 0, 0}},
                                             {{0, 4, 5, 6}, {0, 1, 4, 4}, {1, 2, 3, 4}}, 240.0);
        const Exposed exposed(mesh, uniformSky);
        Errors errors;
        for (double s = 2.0 / std::tan(a) + 1.0; s <= length - 2.0; s += 0.5)
            for (double y = -6.0; y <= 6.0; y += 1.3) {
                const V3d p(-s * std::sin(a), y, s * std::cos(a) - deep);
                const V3d own(-std::sin(a), 0.0, std::cos(a)), other = (V3d(reach, y, 0.0) - p).normalized();
                errors.add(exposed.at(p, V3d(std::cos(a), 0.0, std::sin(a))) - 0.5 * (1.0 - own.dot(other)));
            }
        EXPECT_LT(errors.rms(), 0.005) << half << " degrees: " << errors;
    }
}

TEST(ExposureTruths, FloorOfAHole) {
    const double radius = 14.0;
    for (const auto& [sky, name] : skies)
        for (const double h : {7.0, 14.0, 28.0}) {
            const Exposed exposed(
                test::lathe({{0, -h - 4}, {22, -h - 4}, {22, 0}, {radius, 0}, {radius, -h}, {0, -h}}, 180), sky);
            Errors errors;
            for (double r = 0.0; r <= radius - 2.0; r += 0.5)
                for (double turn = 0.1; turn < 6.2; turn += 0.5) {
                    const V3d p(r * std::cos(turn), r * std::sin(turn), -h);
                    // A disc seen from below, off its axis.
                    const double b = h * h + radius * radius + r * r;
                    double truth =
                        0.5 * (1.0 - (b - 2.0 * radius * radius) / std::sqrt(b * b - 4.0 * radius * radius * r * r));
                    if (sky == overcastSky) {
                        if (r > 0.0)
                            continue; // a closed form on the axis only
                        const double c = h / std::hypot(h, radius);
                        truth = 6.0 / 7.0 * (0.5 * (1.0 - c * c) + 2.0 / 3.0 * (1.0 - c * c * c));
                    }
                    errors.add(exposed.at(p, {0, 0, 1}) - truth);
                }
            EXPECT_LT(errors.rms(), 0.005) << name << ", depth " << h << ": " << errors;
        }
}

TEST(ExposureTruths, InABowlItIsTheSameEverywhere) {
    const double radius = 18.0;
    for (const double open : {60.0, 90.0}) { // half the angle of the opening, seen from the sphere's centre
        std::vector<std::pair<double, double>> profile;
        const double brim = radius * std::cos(open * degree);
        profile = {{0, -radius - 4}, {radius + 6, -radius - 4}, {radius + 6, brim}};
        for (double t = open; t < 180.0; t += 2.0)
            profile.emplace_back(radius * std::sin(t * degree), radius * std::cos(t * degree));
        profile.emplace_back(0.0, -radius);
        const Exposed exposed(test::lathe(profile, 180), uniformSky);
        Errors errors;
        for (double t = open + 8.0; t < 180.0; t += 3.0)
            for (double turn = 0.1; turn < 6.2; turn += 0.4) {
                const V3d out(std::sin(t * degree) * std::cos(turn), std::sin(t * degree) * std::sin(turn),
                              std::cos(t * degree));
                errors.add(exposed.at(out * radius, -out) - 0.5 * (1.0 - std::cos(open * degree)));
            }
        EXPECT_LT(errors.rms(), 0.005) << open << " degrees: " << errors;
    }
}

} // namespace
} // namespace patina
