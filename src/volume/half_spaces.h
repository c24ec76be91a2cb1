#pragma once
// The point of an intersection of half-spaces that is closest to a given one.

#include <Imath/ImathVec.h>

#include <algorithm>
#include <array>
#include <limits>

namespace patina {

/// Half-spaces normal · p >= offset, up to 24.
struct HalfSpaces {
    static constexpr int most = 24;
    std::array<Imath::V3f, most> normal; ///< unit
    std::array<float, most> offset;
    int count = 0;

    /// By how much a point lacks the half-space that it is furthest from; 0 where it is in all of them.
    float lackingAt(const Imath::V3f& p) const {
        float most = 0.f;
        for (int i = 0; i < count; ++i)
            most = std::max(most, offset[i] - normal[i].dot(p));
        return most;
    }

    /// The dual active-set method (Goldfarb and Idnani 1983) in three dimensions: from x, the plane that is lacked most
    /// is stepped onto, along what the planes that hold already leave free; one whose push would turn into a pull lets
    /// go. At most three hold at once, and it mostly ends after one or two steps, also where planes are nearly
    /// parallel.
    Imath::V3f closestTo(const Imath::V3f& x) const {
        constexpr double enough = 1e-4, parallel = 1e-4;
        Imath::V3d p(x), held[3];
        double push[3] = {};
        int holding = 0;
        for (int step = 0; step < 40; ++step) {
            int worst = -1;
            const Imath::V3f here(p);
            float most = float(enough);
            for (int i = 0; i < count; ++i) {
                const float lacking = offset[i] - normal[i].dot(here);
                if (lacking > most) {
                    most = lacking;
                    worst = i;
                }
            }
            if (worst < 0)
                break;
            const Imath::V3d n(normal[worst]);
            double pushed = 0.0;
            for (;;) {
                // n = z + sum of share_j held_j, with z at right angles to all that hold.
                double share[3] = {};
                Imath::V3d free = n;
                if (holding == 1) {
                    share[0] = n.dot(held[0]);
                } else if (holding == 2) {
                    const double c = held[0].dot(held[1]), a = n.dot(held[0]), b = n.dot(held[1]), d = 1.0 - c * c;
                    share[0] = (a - c * b) / d;
                    share[1] = (b - c * a) / d;
                } else if (holding == 3) {
                    const double volume = held[0].dot(held[1].cross(held[2]));
                    share[0] = n.dot(held[1].cross(held[2])) / volume;
                    share[1] = n.dot(held[2].cross(held[0])) / volume;
                    share[2] = n.dot(held[0].cross(held[1])) / volume;
                }
                for (int j = 0; j < holding; ++j)
                    free -= held[j] * share[j];
                const double freedom = holding == 3 ? 0.0 : free.length2();
                double full = std::numeric_limits<double>::infinity(), least = full;
                if (freedom > parallel)
                    full = (double(offset[worst]) - n.dot(p)) / freedom;
                int goes = -1;
                for (int j = 0; j < holding; ++j)
                    if (share[j] > 1e-9 && push[j] / share[j] < least) {
                        least = push[j] / share[j];
                        goes = j;
                    }
                const double length = std::min(full, least);
                if (length == std::numeric_limits<double>::infinity())
                    return Imath::V3f(p); // no point lies in all of them
                for (int j = 0; j < holding; ++j)
                    push[j] -= length * share[j];
                pushed += length;
                if (freedom > parallel)
                    p += free * length;
                if (full <= least) {
                    held[holding] = n;
                    push[holding++] = pushed;
                    break;
                }
                for (int j = goes; j + 1 < holding; ++j) {
                    held[j] = held[j + 1];
                    push[j] = push[j + 1];
                }
                --holding;
            }
        }
        return Imath::V3f(p);
    }
};

} // namespace patina
