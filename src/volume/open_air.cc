#include "volume/open_air.h"

#include "volume/leaf_lattice.h"
#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace patina {

namespace {

using Mask = OpenAir::Mask;

/// Which voxels on a leaf's faces belong to a part of its air: -x, +x, -y, +y, -z, +z.
using Faces = std::array<std::uint64_t, 6>;

/// A leaf's air and its parts, which are what touches within the leaf. Almost always there is one, or none.
struct LeafAir {
    Mask air;
    int parts = 0;
    Faces first;             ///< of the first part
    std::vector<Faces> more; ///< of the others

    const Faces& part(int i) const { return i == 0 ? first : more[i - 1]; }
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

constexpr Mask full{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};

// Word x of a mask has bit 8 y + z.
Faces facesOf(const Mask& m) {
    Faces faces{m[0], m[7], 0, 0, 0, 0};
    const auto everyEighth = [](std::uint64_t word) {
        return (word & 0x0101010101010101ull) * 0x0102040810204080ull >> 56;
    };
    for (int x = 0; x < 8; ++x) {
        faces[2] |= (m[x] & 0xff) << (8 * x);
        faces[3] |= (m[x] >> 56) << (8 * x);
        faces[4] |= everyEighth(m[x]) << (8 * x);
        faces[5] |= everyEighth(m[x] >> 7) << (8 * x);
    }
    return faces;
}

// What of `air` is connected with the voxels in `part`, all 64 voxels of a slab at once.
void flood(const Mask& air, Mask& part) {
    constexpr std::uint64_t low = 0x0101010101010101ull, high = low << 7;
    for (bool grows = true; grows;) {
        grows = false;
        const auto visit = [&](int x) {
            std::uint64_t word = part[x];
            if (x > 0)
                word |= part[x - 1];
            if (x < 7)
                word |= part[x + 1];
            word &= air[x];
            word |= ((word << 1 & ~low) | (word >> 1 & ~high) | word << 8 | word >> 8) & air[x];
            grows = grows || word != part[x];
            part[x] = word;
        };
        for (int x = 0; x < 8; ++x)
            visit(x);
        for (int x = 7; x >= 0; --x)
            visit(x);
    }
}

// Calls visit(voxels) for every part of a leaf's air.
template <typename Visit>
void forParts(const Mask& air, Visit visit) {
    if (air == full) {
        visit(full);
        return;
    }
    Mask rest = air;
    for (int x = 0; x < 8; ++x)
        while (rest[x]) {
            Mask part{};
            part[x] = rest[x] & (~rest[x] + 1);
            flood(air, part);
            for (int i = 0; i < 8; ++i)
                rest[i] &= ~part[i];
            visit(part);
        }
}

void readAir(const float* phi, LeafAir& leaf) {
    leaf.air = voxelsAbove(phi, 0.f);
    forParts(leaf.air, [&](const Mask& part) {
        if (leaf.parts++ == 0)
            leaf.first = facesOf(part);
        else
            leaf.more.push_back(facesOf(part));
    });
}

bool has(const Mask& mask, int voxel) {
    return mask[voxel >> 6] >> (voxel & 63) & 1;
}

} // namespace

OpenAir::OpenAir(const LayerVolume& volume) {
    find(volume.grids(), volume.layerCount(), volume.scale().voxelSize);
}

OpenAir::OpenAir(const LayerVolume& volume, const std::vector<float>& level) {
    NestGrids alone;
    alone.base = volume.grids().surface().deepCopy();
    alone.space = volume.grids().space;
    alone.sides = volume.grids().sides;
    std::size_t at = 0;
    for (FloatLeaf* leaf : leavesOf(alone.base->tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            voxel.setValue(level[at++]);
    find(alone, 0, volume.scale().voxelSize);
}

void OpenAir::find(const NestGrids& grids, int top, double voxelSize) {
    const auto leaves = leavesOf(std::as_const(grids.surface().tree()));
    if (leaves.empty())
        return;
    std::vector<LeafAir> air(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(),
                      [&](std::size_t n) { readAir(leaves[n]->buffer().data(), air[n]); });

    // Nodes: 0 is the outside, then the parts of each leaf, then the runs along z of blocks of 8³ that hold no leaf and
    // are air.
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
    const std::size_t rows = std::size_t(size.x()) * size.y(), length = size.z();
    for (std::size_t row = 0; row < rows; ++row) {
        int* const node = &blockNode[row * length];
        for (std::size_t k = 0; k < length; ++k)
            if (node[k] == 0)
                node[k] = k > 0 && node[k - 1] >= 0 ? node[k - 1] : nodes++;
    }
    std::vector<int> parent(nodes);
    for (int i = 0; i < nodes; ++i)
        parent[i] = i;

    // Joins what touches across a face; a block without a leaf is all of one kind, and beyond the box all is outside.
    const std::size_t stride[3] = {std::size_t(size.y()) * length, length, 1};
    for (std::size_t row = 0; row < rows; ++row) {
        const int i = int(row / size.y()), j = int(row % size.y());
        const int* const node = &blockNode[row * length];
        const bool atSide = i == 0 || j == 0 || i == size.x() - 1 || j == size.y() - 1;
        for (std::size_t k = 0; k < length; ++k) {
            if (node[k] < 0)
                continue;
            if (atSide || k == 0 || k == length - 1)
                join(parent, node[k], 0);
            if (i > 0 && node[k - stride[0]] >= 0)
                join(parent, node[k], node[k - stride[0]]);
            if (j > 0 && node[k - stride[1]] >= 0)
                join(parent, node[k], node[k - stride[1]]);
        }
    }
    // What touches is found leaf by leaf, then joined in order. Between two leaves from the lower one only.
    using Pair = std::pair<int, int>;
    constexpr std::size_t leavesAtOnce = 256;
    std::vector<std::vector<Pair>> touching((leaves.size() + leavesAtOnce - 1) / leavesAtOnce);
    tbb::parallel_for(std::size_t(0), touching.size(), [&](std::size_t batch) {
        const std::size_t end = std::min(leaves.size(), (batch + 1) * leavesAtOnce);
        std::vector<Pair>& pairs = touching[batch];
        const auto touch = [&](int a, int b) {
            if (pairs.empty() || pairs.back() != Pair(a, b))
                pairs.emplace_back(a, b);
        };
        for (std::size_t n = batch * leavesAtOnce; n < end; ++n) {
            if (air[n].parts == 0)
                continue;
            const openvdb::Coord block(leaves[n]->origin() >> 3);
            for (int face = 0; face < 6; ++face) {
                openvdb::Coord next = block;
                next[face / 2] += face % 2 ? 1 : -1;
                const bool within = lattice.holds(next.x(), next.y(), next.z());
                const std::int32_t other = within ? lattice.at(next.x(), next.y(), next.z()) : -1;
                if (other >= 0 && face % 2 == 0)
                    continue;
                const int single = within ? other < 0 ? blockNode[lattice.slot(next)] : -1 : 0;
                for (int a = 0; a < air[n].parts; ++a) {
                    const std::uint64_t mine = air[n].part(a)[face];
                    if (mine && single >= 0)
                        touch(firstNode[n] + a, single);
                    for (int b = 0; mine && other >= 0 && b < air[other].parts; ++b)
                        if (mine & air[other].part(b)[face ^ 1])
                            touch(firstNode[n] + a, firstNode[other] + b);
                }
            }
        }
    });
    for (const auto& pairs : touching)
        for (const Pair& pair : pairs)
            join(parent, pair.first, pair.second);
    // Of a region: air at a side of the box may go on beyond it.
    if (!grids.sides.empty()) {
        openvdb::CoordBBox inside = grids.sides;
        inside.expand(-1);
        const auto isAtSide = [&](const openvdb::Coord& block) {
            return !inside.isInside(openvdb::CoordBBox::createCube(block << 3, 8));
        };
        openvdb::Coord block;
        for (block[0] = box.min().x(); block[0] <= box.max().x(); ++block[0])
            for (block[1] = box.min().y(); block[1] <= box.max().y(); ++block[1])
                for (block[2] = box.min().z(); block[2] <= box.max().z(); ++block[2])
                    if (const int node = blockNode[lattice.slot(block)]; node >= 0 && isAtSide(block))
                        join(parent, node, 0);
        for (std::size_t n = 0; n < leaves.size(); ++n) {
            if (!isAtSide(openvdb::Coord(leaves[n]->origin() >> 3)))
                continue;
            int node = firstNode[n];
            forParts(air[n].air, [&](const Mask& part) {
                for (int voxel = 0; voxel < 512; ++voxel)
                    if (has(part, voxel) &&
                        !inside.isInside(leaves[n]->origin().offsetBy(voxel >> 6, (voxel >> 3) & 7, voxel & 7))) {
                        join(parent, node, 0);
                        break;
                    }
                ++node;
            });
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
    std::vector<Mask> closedAir(leaves.size(), Mask{});
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        int node = firstNode[n];
        forParts(air[n].air, [&](const Mask& part) {
            if (closed[node++])
                for (int w = 0; w < 8; ++w)
                    closedAir[n][w] |= part[w];
        });
    }
    std::vector<std::size_t> count(leaves.size(), 0);
    const NestSampler sampler(grids);
    // Is the air around a point in index space closed? 1 yes, 0 no, -1 there is none.
    const auto airAround = [&](const Imath::V3d& p) {
        const NestCell cell = sampler.locate(p);
        int in = 0, out = 0;
        for (int c = 0; c < 8; ++c) {
            if (cell.leaf[c] < 0) {
                out += cell.leaf[c] == -1;
                continue;
            }
            if (has(air[cell.leaf[c]].air, cell.voxel[c]))
                ++(has(closedAir[cell.leaf[c]], cell.voxel[c]) ? in : out);
        }
        return in + out == 0 ? -1 : in > out;
    };
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel) {
            const int i = static_cast<int>(voxel.pos());
            bool seal = has(closedAir[n], i);
            count[n] += seal;
            if (*voxel <= 0.f) {
                // From the foot on the surface half a voxel on; further where the film of air is farther away.
                const openvdb::Coord c = voxel.getCoord();
                const Imath::V3d gradient = sampler.centralGradient(top, c);
                const double slope = gradient.length();
                if (slope > 0.0) {
                    const Imath::V3d x = grids.space.position(c), way = gradient / slope;
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

std::size_t excludeClosedAir(const LayerVolume& volume, const OpenAir& air, std::vector<float>& thickness) {
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
