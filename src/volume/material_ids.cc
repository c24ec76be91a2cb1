#include "volume/material_ids.h"

#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <Imath/ImathVec.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace patina {

namespace {

// Central differences of the surface at voxels of one leaf, in scene units per voxel.
class LeafGradient {
  public:
    LeafGradient(const LeafLattice& lattice, const std::vector<const FloatLeaf*>& leaves, std::size_t n)
        : here_(leaves[n]->buffer().data()) {
        const openvdb::Coord block(leaves[n]->origin() >> 3);
        const auto data = [&](int i, int j, int k) {
            const std::int32_t number = lattice.at(block.x() + i, block.y() + j, block.z() + k);
            return number < 0 ? nullptr : leaves[number]->buffer().data();
        };
        const float* around[3][2] = {
            {data(-1, 0, 0), data(1, 0, 0)}, {data(0, -1, 0), data(0, 1, 0)}, {data(0, 0, -1), data(0, 0, 1)}};
        std::copy(&around[0][0], &around[0][0] + 6, &around_[0][0]);
        whole_ = std::find(&around[0][0], &around[0][0] + 6, nullptr) == &around[0][0] + 6;
    }

    Imath::V3d at(int pos) const {
        const int x = (pos >> 6) & 7, y = (pos >> 3) & 7, z = pos & 7;
        if (whole_)
            return {central(0, pos, x, 64), central(1, pos, y, 8), central(2, pos, z, 1)};
        return {difference(0, pos, x, 64), difference(1, pos, y, 8), difference(2, pos, z, 1)};
    }

  private:
    // Where all six neighbours are there: no branch on which leaf a value is in.
    double central(int axis, int pos, int along, int stride) const {
        const float* below = along > 0 ? here_ : around_[axis][0];
        const float* above = along < 7 ? here_ : around_[axis][1];
        const int low = along > 0 ? pos - stride : pos + 7 * stride;
        const int high = along < 7 ? pos + stride : pos - 7 * stride;
        return (double(above[high]) - double(below[low])) * 0.5;
    }

    // Across the leaf's faces into its neighbour; where there is none, one-sided.
    double difference(int axis, int pos, int along, int stride) const {
        const float* below = along > 0 ? here_ : around_[axis][0];
        const float* above = along < 7 ? here_ : around_[axis][1];
        const double middle = here_[pos];
        const double low = below ? below[along > 0 ? pos - stride : pos + 7 * stride] : middle;
        const double high = above ? above[along < 7 ? pos + stride : pos - 7 * stride] : middle;
        return (high - low) * (below && above ? 0.5 : 1.0);
    }

    const float* here_;
    const float* around_[3][2];
    bool whole_;
};

// The line of the normal in a voxel: how steep the surface is, and half the line's length times that (both in scene
// units of phi), so that interfaces are compared by their values alone.
struct NormalLine {
    double slope, half;
};

NormalLine normalLine(const Imath::V3d& difference, double voxelSize, double inverseVoxelSize) {
    const Imath::V3d gradient = difference * inverseVoxelSize;
    const double squared = std::max(gradient.length2(), 1e-12), slope = std::sqrt(squared);
    // Half the length of the line is at most half the voxel's diagonal.
    const double steepest = std::max({std::abs(gradient.x), std::abs(gradient.y), std::abs(gradient.z), 0.5 * slope});
    return {slope, 0.5 * voxelSize * squared / steepest};
}

} // namespace

std::size_t updateMaterialIds(LayerVolume& volume, double presenceUm, const std::vector<char>* changedLeaves) {
    NestGrids& grids = volume.grids();
    const double voxelSize = volume.scale().voxelSize;
    const double presence = presenceUm * volume.scale().unitsPerUm();

    std::vector<std::int32_t> ids{1};
    for (const std::string& material : volume.layers())
        ids.push_back(volume.materialId(material));

    std::vector<std::vector<const FloatLeaf*>> nest;
    for (const openvdb::FloatGrid* grid : grids.nest())
        nest.push_back(leavesOf(grid->tree()));
    const auto& top = nest.back();
    const auto idLeaves = leavesOf(grids.material->tree());
    const LeafLattice lattice(top);

    // A voxel's ID depends on its six neighbours too, by the direction of the normal.
    const auto mayChange = [&](std::size_t n) {
        if (!changedLeaves || (*changedLeaves)[n])
            return true;
        const openvdb::Coord b(top[n]->origin() >> 3);
        for (int axis = 0; axis < 3; ++axis)
            for (int side = -1; side <= 1; side += 2) {
                openvdb::Coord c = b;
                c[axis] += side;
                const std::int32_t number = lattice.at(c.x(), c.y(), c.z());
                if (number >= 0 && (*changedLeaves)[number])
                    return true;
            }
        return false;
    };

    const float air = static_cast<float>(0.9 * voxelSize), deep = -air;
    const float deepest = std::nextafter(deep, -std::numeric_limits<float>::infinity()); // above it is deep or more
    std::vector<std::size_t> changed(top.size(), 0);
    // The value that growth in voxels gives to an empty voxel beside particles: a pore stays air, even where the
    // interface cuts its corners.
    const float pore = static_cast<float>(0.5 * voxelSize);
    const int layers = static_cast<int>(nest.size()) - 1;
    const double inverseVoxelSize = 1.0 / voxelSize;
    tbb::parallel_for(std::size_t(0), top.size(), [&](std::size_t n) {
        if (!mayChange(n))
            return;
        std::vector<const float*> values;
        for (const auto& leaves : nest)
            values.push_back(leaves[n]->buffer().data());
        const float* surface = values.back();
        const float* floor = values.front();
        std::int32_t* leafIds = idLeaves[n]->buffer().data();
        const auto set = [&](openvdb::Index pos, std::int32_t id) {
            if (leafIds[pos] != id) {
                leafIds[pos] = id;
                ++changed[n];
            }
        };
        const VoxelMask active = activeVoxelsOf(*top[n]);
        const VoxelMask outside = voxelsAbove(surface, air), notWithin = voxelsAbove(floor, deepest);
        const VoxelMask notAir = voxelsOtherThan(leafIds, 0), notMetal = voxelsOtherThan(leafIds, 1);
        std::array<std::uint16_t, 512> voxels;
        int count = 0;
        for (openvdb::Index w = 0; w < 8; ++w) {
            const auto visit = [w](std::uint64_t word, auto what) {
                for (; word; word &= word - 1)
                    what(w * 64 + openvdb::util::FindLowestOn(word));
            };
            const std::uint64_t inner = ~notWithin[w] & ~outside[w];
            visit(active[w] & outside[w] & notAir[w], [&](openvdb::Index pos) { set(pos, 0); });
            visit(active[w] & inner & notMetal[w], [&](openvdb::Index pos) { set(pos, 1); });
            visit(active[w] & ~outside[w] & ~inner,
                  [&](openvdb::Index pos) { voxels[count++] = static_cast<std::uint16_t>(pos); });
        }
        if (count == 0)
            return;
        // First all lines, whose roots do not wait for one another, then what they meet.
        const LeafGradient gradients(lattice, top, n);
        std::array<NormalLine, 512> lines;
        for (int i = 0; i < count; ++i)
            lines[i] = normalLine(gradients.at(voxels[i]), voxelSize, inverseVoxelSize);
        for (int i = 0; i < count; ++i) {
            const unsigned pos = voxels[i];
            const double half = lines[i].half, thick = presence * lines[i].slope;
            double outer = -double(surface[pos]);
            std::int32_t id = 0;
            if (outer > -half) {
                // Layer k is met from -phi_{k-1} to -phi_k.
                id = 1;
                for (int k = layers; k > 0 && -double(floor[pos]) < half; --k) {
                    const double inner = -double(values[k - 1][pos]);
                    if (std::min(half, outer) - std::max(-half, inner) > thick && values[k][pos] != pore) {
                        id = ids[k];
                        break;
                    }
                    outer = inner;
                }
                // Where no layer is thick enough to show, the metal does, unless it ends below the voxel.
                if (id == 1 && !(-double(floor[pos]) > -half))
                    id = 0;
            }
            set(pos, id);
        }
    });
    return std::accumulate(changed.begin(), changed.end(), std::size_t(0));
}

} // namespace patina
