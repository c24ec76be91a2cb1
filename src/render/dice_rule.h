#pragma once
// Which edges dicing halves: for diced(), and for counting what it will leave.

#include "render/camera.h"
#include "render/dice.h"

#include <algorithm>
#include <array>

namespace patina {

/// Corners and directions are where the camera is. \param camera, options  must outlive it
class DiceRule {
  public:
    using Corners = std::array<Imath::V3f, 3>;

    DiceRule(const Camera& camera, const DiceOptions& options) : camera_(camera), options_(options) {}

    bool isTooLong(const Imath::V3f& a, const Imath::V3f& b) const {
        const float length = (a - b).length();
        if (length > options_.longestEdge)
            return true;
        const Imath::V3f middle = 0.5f * (a + b);
        const float depth = std::max((middle - camera_.position()) ^ camera_.forward(), 0.5f * length);
        return length > options_.pixelsPerEdge * camera_.pixelAt(depth, options_.pictureHeight);
    }

    /// A triangle lies within its longest edge's length of that edge's middle.
    bool isInView(const Corners& corners) const {
        std::size_t longest = 0;
        float squared = -1.f;
        for (std::size_t i = 0; i < 3; ++i)
            if (const float length2 = (corners[i] - corners[(i + 1) % 3]).length2(); length2 > squared) {
                longest = i;
                squared = length2;
            }
        const Imath::V3f &a = corners[longest], &b = corners[(longest + 1) % 3];
        return camera_.sees(0.5f * (a + b), (a - b).length() + options_.margin);
    }

    /// Whether no corner's normal comes within 17 degrees of facing the camera; relief on it is as good as never seen.
    bool isTurnedAway(const Corners& corners, const Corners& normals) const {
        for (std::size_t i = 0; i < 3; ++i) {
            const Imath::V3f toCamera = (camera_.position() - corners[i]).normalized();
            if ((normals[i] ^ toCamera) > -0.3f * normals[i].length())
                return false;
        }
        return true;
    }

    /// The triangle's corner to begin with, so that edge 0, from it on, is split and, of two, edge 2 is not.
    /// \param isSplit  at least one is
    template <typename IsSplit>
    static int firstCorner(int splitEdges, IsSplit&& isSplit) {
        int first = 0;
        while (!isSplit(first) || (splitEdges == 2 && isSplit((first + 2) % 3)))
            ++first;
        return first;
    }

    /// Whether what is left of a triangle abc without the corner b is cut from a to the middle of bc, or from c to that
    /// of ab.
    static bool isCutFromA(const Imath::V3f& a, const Imath::V3f& ab, const Imath::V3f& bc, const Imath::V3f& c) {
        return (a - bc).length2() <= (ab - c).length2();
    }

  private:
    const Camera& camera_;
    const DiceOptions& options_;
};

} // namespace patina
