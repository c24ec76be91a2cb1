#include "operators/even_shift.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patina {

namespace {

constexpr openvdb::Index firstOfGroup = 64 + 8 + 1;

// What is read where there is no leaf: not a number, and neither is the slope there.
const float* nothing() {
    static const auto values = [] {
        std::array<float, FloatLeaf::SIZE> all;
        all.fill(std::numeric_limits<float>::quiet_NaN());
        return all;
    }();
    return values.data();
}

} // namespace

EvenShift::EvenShift(const Workpiece& work, double thickness)
    : binding_(work.binding), leaves_(leavesOf(std::as_const(work.volume.grids().surface().tree()))), lattice_(leaves_),
      inverseVoxelSize_(static_cast<float>(1.0 / work.volume.scale().voxelSize)),
      thickness_(static_cast<float>(thickness)), grids_(work.volume.grids()) {}

void EvenShift::read(std::size_t n, float* budget) const {
    const FloatLeaf& leaf = *leaves_[n];
    const VoxelMask active = activeVoxelsOf(leaf), shares = sharers(leaf.buffer().data(), active);
    VoxelMask own;
    for (unsigned w = 0; w < 8; ++w)
        own[w] = active[w] & ~shares[w];
    std::fill(budget, budget + FloatLeaf::SIZE, 0.f);

    const SurfaceMesh& surface = binding_.surface();
    LeafFeet feet;
    kernel_.findFeet({active.data(), own.data(), binding_.pointsOf(n), surface.triangles.data(),
                      surface.positions.data(), inverseVoxelSize_},
                     feet); // the back of a sheet takes nothing
    if (feet.count == 0)
        return;
    kernel_.readSlopes(around(n), feet);
    for (unsigned i = 0; i < feet.count; ++i) {
        const float slope = feet.slope[i];
        budget[feet.voxel[i]] = (slope < 0.f ? farSlope({feet.x[i], feet.y[i], feet.z[i]}) : slope) * thickness_;
    }
    for (openvdb::Index w = 0; w < 8; ++w)
        for (std::uint64_t word = shares[w]; word; word &= word - 1) {
            const openvdb::Index pos = w * 64 + openvdb::util::FindLowestOn(word);
            budget[pos] = budget[pos & ~firstOfGroup];
        }
}

// The voxels that take the slope of their group's first one: both are active, far, and on one side.
VoxelMask EvenShift::sharers(const float* phi, const VoxelMask& active) const {
    VoxelMask shares{};
    if (binding_.hasBack())
        return shares;
    const float inverse = inverseVoxelSize_, away = 2.f + thickness_ * inverseVoxelSize_;
    const VoxelMask far = voxelsWhere([=](unsigned i) { return std::abs(phi[i]) * inverse > away; });
    const VoxelMask outside = voxelsAbove(phi, 0.f);
    constexpr std::uint64_t firsts = 0x0055005500550055ull;
    const auto spread = [](std::uint64_t word) {
        word &= firsts;
        word |= word << 1;
        return word | word << 8;
    };
    for (unsigned w = 0; w < 8; ++w) {
        const unsigned first = w & ~1u;
        shares[w] = active[w] & far[w] & spread(active[first] & far[first]) & ~(spread(outside[first]) ^ outside[w]);
        if (w == first)
            shares[w] &= ~firsts;
    }
    return shares;
}

SlopeInput EvenShift::around(std::size_t n) const {
    SlopeInput input;
    const openvdb::Coord origin = leaves_[n]->origin(), block(origin >> 3);
    for (int i = 0, at = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k, ++at) {
                const std::int32_t number = lattice_.at(block.x() + i - 1, block.y() + j - 1, block.z() + k - 1);
                input.around[at] = number < 0 ? nothing() : leaves_[number]->buffer().data();
            }
    for (int axis = 0; axis < 3; ++axis)
        input.origin[axis] = origin[axis];
    input.inverseVoxelSize = inverseVoxelSize_;
    return input;
}

// At a foot more than a leaf away, in a wide band.
float EvenShift::farSlope(const Imath::V3f& foot) const {
    // Alone: a thread that waits within for others must not take up another leaf, which would wait for this one.
    std::call_once(needed_, [this] { tbb::this_task_arena::isolate([this] { sampler_.emplace(grids_); }); });
    Imath::V3d gradient;
    sampler_->valueAndGradient(sampler_->interfaceCount() - 1, sampler_->locate(Imath::V3d(foot)), gradient);
    return static_cast<float>(gradient.length()) * inverseVoxelSize_;
}

} // namespace patina
