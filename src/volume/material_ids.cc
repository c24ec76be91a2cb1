#include "volume/material_ids.h"

#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <Imath/ImathVec.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
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
        const float* around[3][2] = {{data(-1, 0, 0), data(1, 0, 0)},
                                     {data(0, -1, 0), data(0, 1, 0)},
                                     {data(0, 0, -1), data(0, 0, 1)}};
        std::copy(&around[0][0], &around[0][0] + 6, &around_[0][0]);
    }

    Imath::V3d at(int pos) const {
        return {difference(0, pos, (pos >> 6) & 7, 64), difference(1, pos, (pos >> 3) & 7, 8),
                difference(2, pos, pos & 7, 1)};
    }

  private:
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
};

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
    const int layers = static_cast<int>(nest.size()) - 1;
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
    // The value that growth in voxels gives to an empty voxel beside particles: a pore stays air, even where the
    // interface cuts its corners.
    const float pore = static_cast<float>(0.5 * voxelSize);
    std::vector<std::size_t> changed(top.size(), 0);
    tbb::parallel_for(std::size_t(0), top.size(), [&](std::size_t n) {
        if (!mayChange(n))
            return;
        const LeafGradient gradients(lattice, top, n);
        const float* surface = top[n]->buffer().data();
        const float* floor = nest[0][n]->buffer().data();
        std::int32_t* leafIds = idLeaves[n]->buffer().data();
        forActive(*top[n], [&](openvdb::Index pos) {
            std::int32_t id = 0;
            // Half the length of the normal's line within the voxel is at most half the diagonal.
            if (surface[pos] > air) {
                id = 0;
            } else if (floor[pos] < deep) {
                id = 1;
            } else {
                Imath::V3d gradient = gradients.at(static_cast<int>(pos)) / voxelSize;
                const double g = std::max(gradient.length(), 1e-6);
                gradient /= g;
                const double steepest =
                    std::max({std::abs(gradient.x), std::abs(gradient.y), std::abs(gradient.z), 0.5});
                const double half = 0.5 * voxelSize / steepest;
                // Layer k lies on the line between -phi_{k-1}/g and -phi_k/g.
                for (int k = layers; k >= 0 && id == 0; --k) {
                    if (k > 0 && nest[k][n]->buffer().data()[pos] == pore)
                        continue;
                    const double outer = std::min(half, -nest[k][n]->buffer().data()[pos] / g);
                    const double inner =
                        k == 0 ? -half
                               : std::max(-half, -static_cast<double>(nest[k - 1][n]->buffer().data()[pos]) / g);
                    if (outer - inner > (k == 0 ? 0.0 : presence))
                        id = ids[k];
                }
            }
            if (leafIds[pos] != id) {
                leafIds[pos] = id;
                ++changed[n];
            }
        });
    });
    return std::accumulate(changed.begin(), changed.end(), std::size_t(0));
}

} // namespace patina
