#include "operators/fields/passages.h"

#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

using Imath::V3f;
using Imath::V3i;

namespace {

constexpr std::size_t mostPoints = 16'000'000;

} // namespace

Passages::Passages(const LayerVolume& volume, int layer, const SurfaceVoxels& surface, double limit, Progress& progress)
    : limit_(static_cast<float>(limit)) {
    V3i lowest(std::numeric_limits<int>::max()), highest(std::numeric_limits<int>::lowest());
    for (const V3i& v : surface.voxels)
        for (int axis = 0; axis < 3; ++axis) {
            lowest[axis] = std::min(lowest[axis], v[axis]);
            highest[axis] = std::max(highest[axis], v[axis]);
        }
    if (surface.size() == 0)
        return;
    const int margin = static_cast<int>(std::ceil(limit)) + 2;
    for (pitch_ = 1;; ++pitch_) {
        std::size_t points = 1;
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = static_cast<int>(std::floor(double(lowest[axis] - margin) / pitch_));
            size_[axis] = static_cast<int>(std::ceil(double(highest[axis] + margin) / pitch_)) - low_[axis] + 1;
            points *= static_cast<std::size_t>(size_[axis]);
        }
        if (points <= mostPoints)
            break;
    }
    distance_.assign(at(size_.x - 1, size_.y - 1, size_.z - 1) + 1, 0.f);
    measureDistances(surface);
    progress.checkpoint();
    const NestSampler sampler(volume.grids());
    tbb::parallel_for(0, size_.x, [&](int i) {
        for (int j = 0; j < size_.y; ++j)
            for (int k = 0; k < size_.z; ++k) {
                const openvdb::Coord c = sampler.space().index((V3i(i, j, k) + low_) * pitch_);
                float& d = distance_[at(i, j, k)];
                d = sampler.voxel(layer, c) <= 0.f ? -1.f : std::min(d, limit_);
            }
    });
    widen();
    progress.checkpoint();
}

// The nearest foot travels from point to point: forward over the 13 neighbours before a point, then backward.
void Passages::measureDistances(const SurfaceVoxels& surface) {
    std::vector<std::int32_t> nearest(distance_.size(), -1);
    std::fill(distance_.begin(), distance_.end(), std::numeric_limits<float>::max());
    const auto offer = [&](int i, int j, int k, std::int32_t foot) {
        const V3f x(float((i + low_.x) * pitch_), float((j + low_.y) * pitch_), float((k + low_.z) * pitch_));
        const float squared = (surface.feet[foot] - x).length2();
        const std::size_t n = at(i, j, k);
        if (squared < distance_[n]) {
            distance_[n] = squared;
            nearest[n] = foot;
        }
    };
    for (std::size_t f = 0; f < surface.size(); ++f) {
        const V3f p = surface.feet[f] / float(pitch_);
        const V3i c(int(std::floor(p.x)) - low_.x, int(std::floor(p.y)) - low_.y, int(std::floor(p.z)) - low_.z);
        for (int corner = 0; corner < 8; ++corner)
            offer(c.x + (corner >> 2), c.y + ((corner >> 1) & 1), c.z + (corner & 1), static_cast<std::int32_t>(f));
    }
    const auto visit = [&](int i, int j, int k, int sense) {
        for (int n = 0; n < 13; ++n) { // the first 13 of 27 come before a point in the order of the lattice
            const int a = i + sense * (n / 9 - 1), b = j + sense * (n / 3 % 3 - 1), c = k + sense * (n % 3 - 1);
            if (a < 0 || b < 0 || c < 0 || a >= size_.x || b >= size_.y || c >= size_.z)
                continue;
            if (const std::int32_t foot = nearest[at(a, b, c)]; foot >= 0)
                offer(i, j, k, foot);
        }
    };
    for (int i = 0; i < size_.x; ++i)
        for (int j = 0; j < size_.y; ++j)
            for (int k = 0; k < size_.z; ++k)
                visit(i, j, k, 1);
    for (int i = size_.x - 1; i >= 0; --i)
        for (int j = size_.y - 1; j >= 0; --j)
            for (int k = size_.z - 1; k >= 0; --k)
                visit(i, j, k, -1);
    for (float& d : distance_)
        d = std::sqrt(d);
}

// Points are taken in the order of their widths, from the border inward: what the widest neighbour lets through, and
// the point's own distance, whichever is less. Widths fall in steps of 1/16 voxel, each with a list of its points.
void Passages::widen() {
    constexpr float steps = 16.f;
    width_.assign(distance_.size(), -1.f);
    std::vector<std::vector<std::uint32_t>> waiting(static_cast<std::size_t>(limit_ * steps) + 2);
    const auto push = [&](std::size_t n, float width) {
        if (width <= width_[n] || distance_[n] <= 0.f)
            return;
        width_[n] = width;
        waiting[static_cast<std::size_t>(width * steps)].push_back(static_cast<std::uint32_t>(n));
    };
    for (int i = 0; i < size_.x; ++i)
        for (int j = 0; j < size_.y; ++j)
            for (int k = 0; k < size_.z; ++k)
                if (i == 0 || j == 0 || k == 0 || i == size_.x - 1 || j == size_.y - 1 || k == size_.z - 1)
                    push(at(i, j, k), distance_[at(i, j, k)]);
    for (std::size_t level = waiting.size(); level-- > 0;)
        for (std::size_t next = 0; next < waiting[level].size(); ++next) { // grows while it is read
            const std::size_t n = waiting[level][next];
            const float width = width_[n];
            if (static_cast<std::size_t>(width * steps) != level)
                continue; // found a wider way since
            const int k = static_cast<int>(n % size_.z), j = static_cast<int>(n / size_.z % size_.y);
            const int i = static_cast<int>(n / (std::size_t(size_.z) * size_.y));
            for (int c = 0; c < 27; ++c) {
                const int a = i + c / 9 - 1, b = j + c / 3 % 3 - 1, d = k + c % 3 - 1;
                if (c == 13 || a < 0 || b < 0 || d < 0 || a >= size_.x || b >= size_.y || d >= size_.z)
                    continue;
                const std::size_t m = at(a, b, d);
                push(m, std::min(width, distance_[m]));
            }
        }
}

bool Passages::reaches(const V3f& place, float radius) const {
    // Ways go from point to point and so lack up to 0.8 of the pitch of the width that they have: half of it on average.
    const float tolerance = 0.4f * static_cast<float>(pitch_);
    const V3f p = place / float(pitch_);
    const V3i c(int(std::floor(p.x)) - low_.x, int(std::floor(p.y)) - low_.y, int(std::floor(p.z)) - low_.z);
    for (int corner = 0; corner < 8; ++corner) {
        const int i = c.x + (corner >> 2), j = c.y + ((corner >> 1) & 1), k = c.z + (corner & 1);
        if (i < 0 || j < 0 || k < 0 || i >= size_.x || j >= size_.y || k >= size_.z)
            return true; // beyond the border nothing is in the way
        if (width_[at(i, j, k)] >= std::min(radius, limit_) - tolerance)
            return true;
    }
    return false;
}

} // namespace patina
