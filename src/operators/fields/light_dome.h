#pragma once
// Where light (or rain) comes from: one distribution over directions, sampled by importance.

#include <Imath/ImathVec.h>

#include <functional>
#include <vector>

namespace patina {

/// Which way the model stands: unit vectors of its space.
struct Compass {
    Imath::V3d up{0.0, 1.0, 0.0};
    Imath::V3d north{0.0, 0.0, -1.0};

    /// North is made perpendicular to up. \throws RunError where up has no length or north lies along it
    static Compass from(const Imath::V3d& up, const Imath::V3d& north);
    /// -z where y is up (as in most scenes the viewer at +z looks north), +y where z is up.
    static Imath::V3d usualNorth(const Imath::V3d& up);

    Imath::V3d east() const { return north.cross(up); }
    /// A direction in the model's space from its parts to the east, the north and up.
    Imath::V3d direction(const Imath::V3d& eastNorthUp) const;
};

/// Power per area from bins of 2° × 2° over the whole sphere; directions as (east, north, up).
class LightDome {
  public:
    LightDome();

    /// Adds irradiance (on a plane facing it) from one direction, such as the sun's.
    void add(const Imath::V3d& direction, double irradiance);
    /// Adds a radiance given over the upper (or lower) hemisphere as a function of the direction, scaled so that a
    /// horizontal plane facing that hemisphere receives `horizontal`.
    void addHemisphere(const std::function<double(const Imath::V3d&)>& radiance, double horizontal, bool upper = true);
    /// Takes over another dome, times a factor.
    void add(const LightDome& other, double factor);

    /// Irradiance of a plane with this normal that nothing shadows.
    double irradiance(const Imath::V3d& normal) const;
    /// The largest irradiance over all normals.
    double largestIrradiance() const;
    /// The sum over all directions.
    double total() const;

    /// `count` × `sets` directions, each standing for total() / count. The sets are blocks of one low-discrepancy
    /// sequence (Sobol's first two dimensions), so each is even by itself, and several together are as even as one
    /// large set. \throws RunError where the dome is dark
    std::vector<Imath::V3d> directions(int count, int sets) const;

  private:
    static constexpr int rows = 90, columns = 180; ///< from straight down to straight up; from north over east
    static const std::vector<Imath::V3d>& centres();
    static double solidAngle(int row);

    std::vector<double> bins_; ///< irradiance on a plane facing the bin
};

} // namespace patina
