#pragma once
// Many rays and what they meet, number by number.

#include "base/vector_lanes.h"

#include <Imath/ImathVec.h>

#include <cstddef>
#include <vector>

namespace patina {

/// Rays to trace together. Its memory is kept from one batch to the next.
struct RayBatch {
    VectorLanes origin, direction;
    std::vector<float> farthest; ///< in lengths of the direction
    std::size_t count = 0;

    void add(const Imath::V3f& from, const Imath::V3f& towards, float reach) {
        if (count == farthest.size())
            reserve(count < 64 ? 64 : 2 * count);
        origin.set(count, from);
        direction.set(count, towards);
        farthest[count++] = reach;
    }
    /// Room for this many, besides what `count` says.
    void reserve(std::size_t most) {
        if (most <= farthest.size())
            return;
        origin.resize(most);
        direction.resize(most);
        farthest.resize(most);
    }
};

/// What the rays of a batch met.
struct HitBatch {
    std::vector<int> triangle; ///< -1: nothing, and the rest has no meaning
    std::vector<float> u, v;   ///< weights of the triangle's second and third corner
    std::vector<float> distance;
    VectorLanes geometricNormal; ///< not normalised, by the triangle's winding

    void resize(std::size_t count) {
        triangle.resize(count);
        for (auto* numbers : {&u, &v, &distance})
            numbers->resize(count);
        geometricNormal.resize(count);
    }
};

} // namespace patina
