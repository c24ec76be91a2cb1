#pragma once
// The point of an intersection of half-spaces that is closest to a given one.

#include <Imath/ImathVec.h>

#include <algorithm>
#include <array>

namespace patina {

/// Half-spaces normal · p >= offset, up to 24.
struct HalfSpaces {
    static constexpr int most = 24;
    std::array<Imath::V3f, most> normal; ///< unit
    std::array<float, most> offset;
    int count = 0;

    /// Hildreth's method: each half-space in turn takes back its own push and pushes as far as is needed now. Mostly one
    /// or two half-spaces hold, and it ends after two or three rounds.
    Imath::V3f closestTo(const Imath::V3f& x) const {
        std::array<float, most> push{};
        Imath::V3f p = x;
        for (int round = 0; round < 60; ++round) {
            float largest = 0.f;
            for (int i = 0; i < count; ++i) {
                const float lacking = offset[i] - normal[i].dot(p);
                const float before = push[i];
                push[i] = std::max(0.f, before + lacking);
                const float change = push[i] - before;
                p += normal[i] * change;
                largest = std::max(largest, std::abs(change));
            }
            if (largest < 2e-4f)
                break;
        }
        return p;
    }
};

} // namespace patina
