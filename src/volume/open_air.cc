#include "volume/open_air.h"

#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr std::uint16_t solid = 0xffff;

/// Air of one leaf: which of its parts, that touch within the leaf, each voxel is of.
struct LeafAir {
    bool uniform = true; ///< one part, or none
    std::uint16_t parts = 0;
};

int rootOf(std::vector<int>& parent, int i) {
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

void join(std::vector<int>& parent, int a, int b) {
    a = rootOf(parent, a);
    b = rootOf(parent, b);
    parent[std::max(a, b)] = std::min(a, b);
}

LeafAir labelLeaf(const float* phi, std::uint16_t* label) {
    int air = 0;
    for (int i = 0; i < 512; ++i)
        air += phi[i] > 0.f;
    if (air == 0 || air == 512) {
        std::fill(label, label + 512, air ? std::uint16_t(0) : solid);
        return {true, static_cast<std::uint16_t>(air ? 1 : 0)};
    }
    // Roots are the smallest of their part, so that one pass forward numbers the parts.
    std::uint16_t parent[512];
    const auto root = [&](int i) {
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    };
    const auto joined = [&](int a, int b) {
        const int ra = root(a), rb = root(b);
        parent[std::max(ra, rb)] = static_cast<std::uint16_t>(std::min(ra, rb));
    };
    for (int i = 0; i < 512; ++i) {
        parent[i] = static_cast<std::uint16_t>(i);
        if (!(phi[i] > 0.f))
            continue;
        if ((i & 7) && phi[i - 1] > 0.f)
            joined(i, i - 1);
        if ((i & 56) && phi[i - 8] > 0.f)
            joined(i, i - 8);
        if (i >= 64 && phi[i - 64] > 0.f)
            joined(i, i - 64);
    }
    LeafAir result{false, 0};
    for (int i = 0; i < 512; ++i)
        label[i] = !(phi[i] > 0.f) ? solid : parent[i] == i ? result.parts++ : label[root(i)];
    return result;
}

} // namespace

OpenAir::OpenAir(const LayerVolume& volume) {
    const NestGrids& grids = volume.grids();
    const auto leaves = leavesOf(std::as_const(grids.surface().tree()));
    if (leaves.empty())
        return;
    std::vector<std::uint16_t> label(leaves.size() * 512);
    std::vector<LeafAir> air(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        air[n] = labelLeaf(leaves[n]->buffer().data(), label.data() + n * 512);
    });

    // Nodes: 0 is the outside, then the parts of each leaf, then the blocks of 8³ that hold no leaf and are air.
    const LeafLattice lattice(leaves);
    const openvdb::CoordBBox& box = lattice.box();
    const openvdb::Coord size = box.dim();
    std::vector<int> firstNode(leaves.size());
    int nodes = 1;
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        firstNode[n] = nodes;
        nodes += air[n].parts;
    }
    std::vector<int> blockNode(std::size_t(size.x()) * size.y() * size.z(), -1);
    tbb::parallel_for(box.min().x(), box.max().x() + 1, [&](int i) {
        const auto accessor = grids.surface().getConstAccessor();
        std::size_t slot = lattice.slot({i, box.min().y(), box.min().z()});
        for (int j = box.min().y(); j <= box.max().y(); ++j)
            for (int k = box.min().z(); k <= box.max().z(); ++k, ++slot)
                if (lattice.marked(slot) < 0 && accessor.getValue(openvdb::Coord(i, j, k) << 3) > 0.f)
                    blockNode[slot] = 0;
    });
    for (int& node : blockNode)
        if (node == 0)
            node = nodes++;
    std::vector<int> parent(nodes);
    for (int i = 0; i < nodes; ++i)
        parent[i] = i;

    // The node of a voxel on a leaf's face, or of the block itself; -1 where it is solid.
    const auto nodeOf = [&](std::int32_t leaf, std::size_t slot, int voxel) {
        if (leaf < 0)
            return blockNode[slot];
        const std::uint16_t part = label[std::size_t(leaf) * 512 + voxel];
        return part == solid ? -1 : firstNode[leaf] + part;
    };
    const int steps[3] = {64, 8, 1};
    std::size_t slot = 0;
    for (int i = box.min().x(); i <= box.max().x(); ++i)
        for (int j = box.min().y(); j <= box.max().y(); ++j)
            for (int k = box.min().z(); k <= box.max().z(); ++k, ++slot) {
                const std::int32_t leaf = lattice.at(i, j, k);
                if (leaf < 0 && blockNode[slot] < 0)
                    continue;
                const openvdb::Coord block(i, j, k);
                for (int axis = 0; axis < 3; ++axis) {
                    const int u = steps[axis == 0 ? 1 : 0], v = steps[axis == 2 ? 1 : 2];
                    for (const int far : {0, 7}) {
                        openvdb::Coord next = block;
                        next[axis] += far ? 1 : -1;
                        const bool inBox = lattice.holds(next.x(), next.y(), next.z());
                        if (inBox && !far)
                            continue; // joined from the other side
                        const std::size_t nextSlot = inBox ? lattice.slot(next) : 0;
                        const std::int32_t nextLeaf = inBox ? lattice.at(next.x(), next.y(), next.z()) : -1;
                        const bool single = (leaf < 0 || air[leaf].uniform) &&
                                            (!inBox || nextLeaf < 0 || air[nextLeaf].uniform);
                        int lastHere = -1, lastThere = -1;
                        for (int a = 0; a < (single ? 1 : 8); ++a)
                            for (int b = 0; b < (single ? 1 : 8); ++b) {
                                const int at = a * u + b * v;
                                const int here = nodeOf(leaf, slot, at + far * steps[axis]);
                                const int there = inBox ? nodeOf(nextLeaf, nextSlot, at) : 0;
                                if (here < 0 || there < 0 || (here == lastHere && there == lastThere))
                                    continue;
                                join(parent, here, there);
                                lastHere = here;
                                lastThere = there;
                            }
                    }
                }
            }

    std::vector<char> closed(nodes, 0);
    for (int i = 1; i < nodes; ++i) {
        closed[i] = rootOf(parent, i) != 0;
        closedPores_ += closed[i] && parent[i] == i;
    }
    if (closedPores_ == 0)
        return;

    sealed_.assign(leaves.size(), Mask{});
    const auto isClosed = [&](std::size_t n, int voxel) {
        const std::uint16_t part = label[n * 512 + voxel];
        return part != solid && closed[firstNode[n] + part];
    };
    std::vector<std::size_t> count(leaves.size(), 0);
    const NestSampler sampler(grids);
    const int top = volume.layerCount();
    const double voxelSize = volume.scale().voxelSize;
    // Is the air around a point in index space closed? 1 yes, 0 no, -1 there is none.
    const auto airAround = [&](const Imath::V3d& p) {
        const NestCell cell = sampler.locate(p);
        int in = 0, out = 0;
        for (int c = 0; c < 8; ++c) {
            if (cell.leaf[c] < 0) {
                out += cell.leaf[c] == -1;
                continue;
            }
            const std::uint16_t part = label[std::size_t(cell.leaf[c]) * 512 + cell.voxel[c]];
            if (part != solid)
                ++(closed[firstNode[cell.leaf[c]] + part] ? in : out);
        }
        return in + out == 0 ? -1 : in > out;
    };
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel) {
            const int i = static_cast<int>(voxel.pos());
            bool seal = isClosed(n, i);
            count[n] += seal;
            if (*voxel <= 0.f) {
                // From the foot on the surface half a voxel on; further where the film of air is farther away.
                const openvdb::Coord c = voxel.getCoord();
                const Imath::V3d gradient = sampler.centralGradient(top, c);
                const double slope = gradient.length();
                if (slope > 0.0) {
                    const Imath::V3d x(c.x(), c.y(), c.z()), way = gradient / slope;
                    const double depth = -double(*voxel) / voxelSize;
                    for (double more = 0.25; more < 2.0; more += 0.5) {
                        const int around = airAround(x + way * (depth + more));
                        if (around >= 0) {
                            seal = around == 1;
                            break;
                        }
                    }
                }
            }
            if (seal)
                sealed_[n][i >> 6] |= std::uint64_t(1) << (i & 63);
        }
    });
    for (const std::size_t c : count)
        closedVoxels_ += c;
}

const OpenAir::Mask& OpenAir::sealed(std::size_t n) const {
    static const Mask none{};
    return sealed_.empty() ? none : sealed_[n];
}

std::size_t excludeClosedAir(const LayerVolume& volume, std::vector<float>& thickness) {
    const OpenAir air(volume);
    if (!air.anyClosed())
        return 0;
    const auto leaves = leavesOf(std::as_const(volume.grids().base->tree()));
    std::size_t at = 0, excluded = 0;
    for (std::size_t n = 0; n < leaves.size(); ++n)
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel, ++at)
            if (air.isSealed(n, voxel.pos()) && thickness[at] != 0.f) {
                thickness[at] = 0.f;
                ++excluded;
            }
    return excluded;
}

} // namespace patina
