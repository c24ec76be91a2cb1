#include "volume/inside_signs.h"

#include "volume/leaf_lattice.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr int fewInGroup = 32;

int findRoot(std::vector<int>& parent, int i) {
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

void join(std::vector<int>& parent, int a, int b) {
    a = findRoot(parent, a);
    b = findRoot(parent, b);
    parent[std::max(a, b)] = std::min(a, b);
}

} // namespace

SideGroups::SideGroups(const openvdb::FloatGrid& grid, double voxelSize)
    : leaves_(leavesOf(grid.tree())), space_(grid.transform()), voxelSize_(voxelSize), groupOf_(leaves_.size() * 512, -1) {
    // A little more than a voxel, for the rounding of the distances.
    const float apart = static_cast<float>(1.01 * voxelSize);
    const auto joined = [&](const FloatLeaf& a, int i, const FloatLeaf& b, int j) {
        return a.isValueOn(i) && b.isValueOn(j) && std::abs(a.getValue(i)) + std::abs(b.getValue(j)) > apart;
    };
    std::vector<int>& parent = groupOf_;
    tbb::parallel_for(std::size_t(0), leaves_.size(), [&](std::size_t n) {
        const FloatLeaf& leaf = *leaves_[n];
        const int first = static_cast<int>(n * 512);
        forActive(leaf, [&](openvdb::Index i) { parent[first + i] = first + static_cast<int>(i); });
        for (int i = 0; i < 512; ++i) {
            if ((i & 7) < 7 && joined(leaf, i, leaf, i + 1))
                join(parent, first + i, first + i + 1);
            if ((i & 56) < 56 && joined(leaf, i, leaf, i + 8))
                join(parent, first + i, first + i + 8);
            if (i < 448 && joined(leaf, i, leaf, i + 64))
                join(parent, first + i, first + i + 64);
        }
    });
    const LeafLattice lattice(leaves_);
    for (std::size_t n = 0; n < leaves_.size(); ++n) {
        const openvdb::Coord block = leaves_[n]->origin() >> 3;
        for (int axis = 0; axis < 3; ++axis) {
            const int other = lattice.at(block.x() + (axis == 0), block.y() + (axis == 1), block.z() + (axis == 2));
            if (other < 0)
                continue;
            const int step = axis == 0 ? 64 : axis == 1 ? 8 : 1;
            const int u = axis == 0 ? 8 : 64, v = axis == 2 ? 8 : 1;
            for (int a = 0; a < 8; ++a)
                for (int b = 0; b < 8; ++b) {
                    const int j = a * u + b * v, i = j + 7 * step;
                    if (joined(*leaves_[n], i, *leaves_[other], j))
                        join(parent, static_cast<int>(n * 512) + i, other * 512 + j);
                }
        }
    }
    // A root is the smallest of its group, so its number is known before the others ask for it.
    for (std::size_t n = 0; n < leaves_.size(); ++n)
        for (int i = 0; i < 512; ++i) {
            const int at = static_cast<int>(n * 512) + i;
            if (parent[at] < 0)
                continue;
            if (parent[at] == at) {
                parent[at] = static_cast<int>(groups_.size());
                groups_.emplace_back();
            } else {
                // Ancestors behind `at` are numbered already: what they hold is their group.
                parent[at] = parent[parent[at]];
            }
            Group& group = groups_[parent[at]];
            ++group.size;
            const int slot = static_cast<int>(n & 3);
            const float depth = std::abs(leaves_[n]->getValue(i));
            if (group.samples[slot] < 0 || depth > group.depths[slot]) {
                group.samples[slot] = at;
                group.depths[slot] = depth;
            }
        }
}

Imath::V3d SideGroups::placeOf(int voxel) const {
    const openvdb::Coord c = leaves_[voxel >> 9]->offsetToGlobalCoord(static_cast<openvdb::Index>(voxel & 511));
    return space_.position(c) * voxelSize_;
}

SideGroups::Side SideGroups::sideOf(const Group& group, const WindingNumber& winding) const {
    int in = 0, out = 0;
    for (const int sample : group.samples)
        if (sample >= 0)
            ++(winding.at(placeOf(sample)) >= 0.5 ? in : out);
    return in && out ? mixed : in ? inside : outside;
}

bool SideGroups::agree(const WindingNumber& winding) const {
    for (const Group& group : groups_) {
        if (group.size < fewInGroup)
            continue;
        const Side side = sideOf(group, winding);
        for (const int sample : group.samples)
            if (sample >= 0 && (side == mixed || (leaves_[sample >> 9]->getValue(sample & 511) < 0.f) != (side == inside)))
                return false;
    }
    return true;
}

void SideGroups::apply(const WindingNumber& winding, openvdb::FloatGrid& grid) const {
    std::vector<char> side(groups_.size());
    tbb::parallel_for(std::size_t(0), groups_.size(), [&](std::size_t g) { side[g] = sideOf(groups_[g], winding); });
    set(side, winding, grid);
}

void SideGroups::correct(const WindingNumber& winding, openvdb::FloatGrid& grid) const {
    std::vector<char> side(groups_.size(), asItIs);
    tbb::parallel_for(std::size_t(0), groups_.size(), [&](std::size_t g) {
        if (groups_[g].size < fewInGroup)
            side[g] = sideOf(groups_[g], winding);
    });
    set(side, winding, grid);
}

void SideGroups::set(const std::vector<char>& side, const WindingNumber& winding, openvdb::FloatGrid& grid) const {
    const auto leaves = leavesOf(grid.tree());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel) {
            const int at = static_cast<int>(n * 512 + voxel.pos());
            const char known = side[groupOf_[at]];
            if (known == asItIs)
                continue;
            const bool in = known == mixed ? winding.at(placeOf(at)) >= 0.5 : known == inside;
            voxel.setValue(in ? -std::abs(*voxel) : std::abs(*voxel));
        }
    });
}

} // namespace patina
