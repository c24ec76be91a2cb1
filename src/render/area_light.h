#pragma once
// Lights that stand in the scene: rectangles and discs, near enough that light falls off with distance.

#include "render/frame.h"

#include <Imath/ImathVec.h>

#include <limits>
#include <optional>
#include <vector>

namespace patina {

/// A luminous rectangle or disc. Its front shines, with the same radiance in all directions; its back is dark and it
/// casts no shadow, as if cut out of the picture. The camera does not see it, surfaces reflect it.
struct AreaLight {
    enum class Shape { rectangle, disc };
    Shape shape = Shape::rectangle;
    Imath::V3f centre{0.f};   ///< scene units
    Frame frame;              ///< normal: the direction it shines to; tangent: along halfWidth
    float halfWidth = 1.f;    ///< scene units; of a disc the radius
    float halfHeight = 1.f;   ///< of a rectangle
    Imath::V3f radiance{1.f}; ///< linear Rec.709, at its middle
    float softEdge = 0.f;     ///< 0…1: the part of the half sizes over which a rectangle fades to nothing
    float dimming = 0.f;      ///< 0…1: how much darker a rectangle is towards its corners, as a lamp behind cloth

    float area() const;
    /// Of a rectangle's light that its soft edge leaves, 0…1, at a point in halves of its size.
    float edgeShare(float u, float v) const;
    /// The same on average over its area.
    float meanEdgeShare() const { return (1.f - 0.5f * edge()) * (1.f - 0.5f * edge()); }
    /// At a point of its plane, in halves of its size: (0, 0) the middle, (±1, ±1) the corners. 0 outside.
    Imath::V3f radianceAt(float u, float v) const;

  private:
    float edge() const { return shape == Shape::disc ? 0.f : softEdge; }
};

/// Several of them, sampled by importance. Immutable after construction; safe from any thread.
class AreaLightSet {
  public:
    AreaLightSet() = default;
    static constexpr std::size_t mostLights = 64;
    /// \throws RunError for a light without size, or whose radiance is negative or not finite, or too many lights
    explicit AreaLightSet(std::vector<AreaLight> lights);

    bool empty() const { return lights_.empty(); }
    const std::vector<AreaLight>& lights() const { return lights_; }
    double power() const { return power_; } ///< of all: luminance times area

    struct Sample {
        Imath::V3f direction{0, 0, 1}; ///< unit
        float distance = 0.f;
        Imath::V3f radiance{0.f};
        float pdf = 0.f; ///< per solid angle, the choice among the lights included; 0: nothing to see
    };
    /// A point of one light, chosen by what each may do for a surface at this place with this normal, and then as
    /// densely as its soft edge leaves light there.
    Sample sample(const Imath::V3f& position, const Imath::V3f& normal, Imath::V2f random) const;

    /// Light k where a ray from `position` meets its front nearer than `farthest`, with the density with which sample()
    /// draws that point for this normal.
    std::optional<Sample> hit(std::size_t k, const Imath::V3f& position, const Imath::V3f& normal,
                              const Imath::V3f& direction,
                              float farthest = std::numeric_limits<float>::infinity()) const;

    /// On a surface that nothing shadows, by quadrature over the lights (a thousandth where it is further away than a
    /// light is large).
    Imath::V3f irradiance(const Imath::V3f& position, const Imath::V3f& normal) const;

  private:
    /// What choosing a light asks for.
    struct Beacon {
        Imath::V3f centre, normal;
        float strength; ///< luminance, on average over it, times area
        float size;     ///< half its longer side
    };
    /// Of choosing each light, in proportion; never 0 for one that can be seen from the place. \returns their sum
    float weigh(const Imath::V3f& position, const Imath::V3f& normal, float* weights) const;

    std::vector<AreaLight> lights_;
    std::vector<Beacon> beacons_; ///< of each light
    double power_ = 0.0;
};

} // namespace patina
