#pragma once
// Light from far away, as radiance over directions: the base of every sky, set and map.

#include "base/vector_lanes.h"
#include "render/frame.h"

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace patina {

/// Radiance from many directions at once. Arrays have room up to the next multiple of 16 of `count`; what lies behind
/// `count` is written but has no meaning.
struct RadianceLanes {
    std::size_t count;
    ConstVectors direction; ///< unit
    Vectors radiance;
};

/// Radiance arriving from infinitely far, linear Rec.709. Immutable; safe from any thread.
class Environment {
  public:
    virtual ~Environment() = default;
    /// Radiance from a unit direction (pointing away from the scene), finite and not negative.
    virtual Imath::V3f radiance(const Imath::V3f& direction) const = 0;
    /// The same of many directions, to the bit.
    virtual void radiance(const RadianceLanes& lanes) const;
    /// Whether radiance() is the same in all directions: such light needs no table.
    virtual bool isUniform() const { return false; }
    /// How many looks each way tell what a cell of 1.9 degrees holds, for the tables it is sampled by.
    virtual int looksPerCell() const { return 3; }
};

/// The same radiance from everywhere: an overcast furnace.
class UniformEnvironment final : public Environment {
  public:
    explicit UniformEnvironment(const Imath::V3f& radiance) : radiance_(radiance) {}
    Imath::V3f radiance(const Imath::V3f&) const override { return radiance_; }
    void radiance(const RadianceLanes& lanes) const override;
    bool isUniform() const override { return true; }

  private:
    Imath::V3f radiance_;
};

/// A photographer's set around the object: a sky that brightens towards the horizon, darker ground, and soft boxes for
/// metal to reflect. White balanced: no part is far from neutral, so that colours are the material's own.
class StudioEnvironment final : public Environment {
  public:
    /// A luminous rectangle infinitely far away, with soft edges.
    struct SoftBox {
        float azimuthDegrees;   ///< from the viewer's side of the object; positive: to the viewer's right
        float elevationDegrees; ///< of the centre
        float halfWidthDegrees;
        float halfHeightDegrees;
        Imath::V3f radiance;
    };

    /// `azimuthDegrees` is the camera's: the set stands as seen by the viewer.
    /// Without `boxes` it is the dome alone, for lights that stand in the scene (lights.h, studioSet).
    explicit StudioEnvironment(UpAxis up, float azimuthDegrees = 0.f, bool boxes = true);
    static const std::vector<SoftBox>& softBoxes();
    using Environment::radiance;
    Imath::V3f radiance(const Imath::V3f& direction) const override;

  private:
    struct Box {
        Frame frame;                 ///< normal: to the box's centre
        float halfWidth, halfHeight; ///< tangents of the angles
        Imath::V3f radiance;
    };
    Frame set_;
    std::vector<Box> boxes_;
};

} // namespace patina
