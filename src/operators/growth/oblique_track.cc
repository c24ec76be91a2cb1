#include "operators/growth/oblique_track.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace patina {

namespace {

/// The step to the next cell along a tangential direction (`forwards` is its slot 1 or 3).
std::optional<Imath::V3d> stepAlong(const GrowthLattice& lattice, int cell, int forwards) {
    const auto& next = lattice.neighbours[std::size_t(cell)];
    if (next[std::size_t(forwards)] >= 0)
        return linkVector(lattice, cell, next[std::size_t(forwards)]);
    if (next[std::size_t(forwards - 1)] >= 0)
        return -linkVector(lattice, cell, next[std::size_t(forwards - 1)]);
    return {};
}

/// a and b of motion = a u + b v + (something along the normal).
Imath::V2f inSteps(const Imath::V3d& motion, const std::optional<Imath::V3d>& u, const std::optional<Imath::V3d>& v) {
    const auto alone = [&](const Imath::V3d& step) { return float(motion.dot(step) / step.length2()); };
    if (!u || !v)
        return {u ? alone(*u) : 0.f, v ? alone(*v) : 0.f};
    const double uu = u->length2(), vv = v->length2(), uv = u->dot(*v), mu = motion.dot(*u), mv = motion.dot(*v);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-6 * uu * vv))
        return {alone(*u), 0.f};
    return {float((mu * vv - mv * uv) / determinant), float((mv * uu - mu * uv) / determinant)};
}

} // namespace

ObliqueTrack::ObliqueTrack(const GrowthLattice& lattice, const Imath::V3d& towards, double levelHeight,
                           const std::vector<std::int32_t>& relief)
    : lattice_(lattice), relief_(relief), drift_(lattice.size(), Imath::V2f(0.f)) {
    tbb::parallel_for(std::size_t(0), lattice.size(), [&](std::size_t i) {
        const Imath::V3d normal(lattice.normals[i]);
        const double cosine = towards.dot(normal);
        Imath::V3d sideways = towards - normal * cosine;
        const double steepness = sideways.length() / std::max(cosine, 1e-9);
        if (!(cosine > 0.0) || !(steepness > 0.0))
            return;
        sideways *= std::min(steepness, flattestTrack) / sideways.length() * levelHeight * lattice.cell;
        drift_[i] = inSteps(sideways, stepAlong(lattice, int(i), 1), stepAlong(lattice, int(i), 3));
    });
}

bool ObliqueTrack::touches(int cell, std::int32_t level, const LevelOccupancy& occupancy) const {
    if (isFilled(cell, level - 1, occupancy))
        return true;
    const auto& around = lattice_.neighbours[std::size_t(cell)];
    return std::any_of(around.begin(), around.end(),
                       [&](int next) { return next >= 0 && isFilled(next, level, occupancy); });
}

void ObliqueTrack::follow(int foot, std::uint32_t within, float top) {
    path_.clear();
    within *= 2654435761u; // the words of arrivals are in order of time
    float at[2] = {float(within >> 16) / 65536.f - 0.5f, float(within & 0xffffu) / 65536.f - 0.5f};
    int cell = foot;
    for (float z = 0.f; z < top;) {
        const Imath::V2f drift = drift_[std::size_t(cell)];
        float leaves = top - z; // height until the track goes into the next column
        int through = -1;
        for (int axis = 0; axis < 2; ++axis) {
            const float speed = std::abs(drift[axis]);
            if (!(speed > 1e-6f))
                continue;
            const float dz = std::max(0.f, (0.5f - (drift[axis] > 0.f ? at[axis] : -at[axis])) / speed);
            if (dz < leaves) {
                leaves = dz;
                through = 2 * axis + (drift[axis] > 0.f);
            }
        }
        path_.push_back({cell, z, z + leaves});
        const int next = through < 0 ? -1 : lattice_.neighbours[std::size_t(cell)][std::size_t(through)];
        if (next < 0)
            return;
        // Into the next column by the side that leads back; beyond a seam of facets along its middle.
        const auto& back = lattice_.neighbours[std::size_t(next)];
        const auto side = std::find(back.begin(), back.end(), cell) - back.begin();
        if (side == (through ^ 1) && lattice_.axes[std::size_t(cell)] == lattice_.axes[std::size_t(next)]) {
            const int other = 1 - through / 2;
            at[other] = std::clamp(at[other] + drift[other] * leaves, -0.5f, 0.5f);
        } else {
            at[0] = at[1] = 0.f;
        }
        if (side < 4)
            at[side / 2] = side % 2 ? 0.5f : -0.5f;
        // Over an edge into a surface above which the track does not rise: what is beyond was for rays to say.
        const Imath::V2f onward = drift_[std::size_t(next)];
        if (onward == Imath::V2f(0.f) || (side < 4 && onward[int(side / 2)] * (side % 2 ? -1.f : 1.f) < 0.f))
            return;
        z += leaves;
        cell = next;
    }
}

ObliqueTrack::Place ObliqueTrack::firstContact(int foot, std::uint32_t within, const std::vector<std::int32_t>& height,
                                               std::int32_t highest, const LevelOccupancy& occupancy) {
    follow(foot, within, float(highest) + 1.f);
    for (auto piece = path_.rbegin(); piece != path_.rend(); ++piece) {
        // Levels 1, 2, … fill heights 0…1, 1…2, …; what is above the envelopes touches nothing.
        const int cell = piece->cell;
        const auto first = static_cast<std::int32_t>(std::floor(piece->from)) + 1;
        std::int32_t reach = height[std::size_t(cell)] + 1;
        for (const int next : lattice_.neighbours[std::size_t(cell)])
            if (next >= 0)
                reach = std::max(reach, height[std::size_t(next)]);
        for (std::int32_t level = std::min(reach, static_cast<std::int32_t>(std::ceil(piece->to))); level >= first;
             --level)
            if (!isFilled(cell, level, occupancy) && touches(cell, level, occupancy))
                return {cell, level};
    }
    return {foot, height[std::size_t(foot)] + 1}; // where the track comes from beyond the surface's border
}

} // namespace patina
