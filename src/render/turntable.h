#pragma once
// The round table that a studio's object stands on.

#include "render/scene.h"

#include <Imath/ImathVec.h>

#include <optional>

namespace patina {

/// A flat round slab: its top is the floor under the object, the studio's own floor lies lower by its thickness. Matte.
class Turntable {
  public:
    /// \param middle  of its top \param up  unit
    Turntable(const Imath::V3f& middle, const Imath::V3f& up, float radius, float thickness)
        : middle_(middle), up_(up), radius_(radius), thickness_(thickness) {}

    float radius() const { return radius_; }
    float thickness() const { return thickness_; }

    struct Hit {
        float distance;
        Imath::V3f normal; ///< unit, outward
    };
    /// The first way into it from outside, nearer than `farthest`. From inside: nothing.
    std::optional<Hit> intersect(const Imath::V3f& origin, const Imath::V3f& direction, float farthest) const;

  private:
    Imath::V3f middle_, up_;
    float radius_, thickness_;
};

} // namespace patina
