#include "volume/open_air.h"

#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace patina {

namespace {

using Mask = OpenAir::Mask;

/// Voxels of a leaf's air that touch within the leaf, and which of them lie on its faces: -x, +x, -y, +y, -z, +z.
struct AirPart {
    Mask voxels;
    std::array<std::uint64_t, 6> faces;
};

struct LeafAir {
    Mask air;
    std::vector<AirPart> parts;
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

// One bit for each value above zero.
Mask signsOf(const float* phi) {
    Mask mask;
    for (std::uint64_t& word : mask) {
        unsigned char above[64];
        for (int i = 0; i < 64; ++i)
            above[i] = phi[i] > 0.f;
        word = 0;
        for (int row = 0; row < 8; ++row) {
            std::uint64_t bytes;
            std::memcpy(&bytes, above + 8 * row, 8);
            // Eight bytes of 0 or 1 become eight bits.
            word |= (bytes * 0x0102040810204080ull >> 56) << (8 * row);
        }
        phi += 64;
    }
    return mask;
}

// Word x of a mask has bit 8 y + z.
std::array<std::uint64_t, 6> facesOf(const Mask& m) {
    std::array<std::uint64_t, 6> faces{m[0], m[7], 0, 0, 0, 0};
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

LeafAir airOf(const float* phi) {
    LeafAir leaf{signsOf(phi), {}};
    const Mask& air = leaf.air;
    Mask rest = air;
    for (int x = 0; x < 8; ++x)
        while (rest[x]) {
            AirPart part{};
            part.voxels[x] = rest[x] & (~rest[x] + 1);
            if (air == full)
                part.voxels = full;
            flood(air, part.voxels);
            for (int i = 0; i < 8; ++i)
                rest[i] &= ~part.voxels[i];
            part.faces = facesOf(part.voxels);
            leaf.parts.push_back(part);
        }
    return leaf;
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
                      [&](std::size_t n) { air[n] = airOf(leaves[n]->buffer().data()); });

    // Nodes: 0 is the outside, then the parts of each leaf, then the blocks of 8³ that hold no leaf and are air.
    const LeafLattice lattice(leaves);
    const openvdb::CoordBBox& box = lattice.box();
    const openvdb::Coord size = box.dim();
    std::vector<int> firstNode(leaves.size());
    int nodes = 1;
    for (std::size_t n = 0; n < leaves.size(); ++n) {
        firstNode[n] = nodes;
        nodes += static_cast<int>(air[n].parts.size());
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

    // Joins what touches across a face; a block without a leaf is all of one kind.
    struct Side {
        int node = -1;
        const std::vector<AirPart>* parts = nullptr;
    };
    const auto sideOf = [&](const openvdb::Coord& block) {
        if (!lattice.holds(block.x(), block.y(), block.z()))
            return Side{0, nullptr};
        const std::int32_t leaf = lattice.at(block.x(), block.y(), block.z());
        return leaf < 0 ? Side{blockNode[lattice.slot(block)], nullptr} : Side{firstNode[leaf], &air[leaf].parts};
    };
    const auto joinAcross = [&](const Side& here, const Side& there, int face) {
        const std::size_t mine = here.parts ? here.parts->size() : here.node >= 0,
                          others = there.parts ? there.parts->size() : there.node >= 0;
        for (std::size_t a = 0; a < mine; ++a)
            for (std::size_t b = 0; b < others; ++b) {
                const std::uint64_t mineThere = here.parts ? (*here.parts)[a].faces[face] : ~std::uint64_t(0),
                                    othersHere = there.parts ? (*there.parts)[b].faces[face ^ 1] : ~std::uint64_t(0);
                if (mineThere & othersHere)
                    join(parent, here.node + static_cast<int>(a), there.node + static_cast<int>(b));
            }
    };
    // Of a region: air at a side of the box may go on beyond it.
    openvdb::CoordBBox inside = grids.sides;
    if (!inside.empty())
        inside.expand(-1);
    const auto joinSides = [&](const openvdb::Coord& block, const Side& here) {
        const openvdb::Coord origin = block << 3;
        if (inside.empty() || inside.isInside(openvdb::CoordBBox::createCube(origin, 8)))
            return;
        if (!here.parts && here.node >= 0)
            join(parent, here.node, 0);
        for (std::size_t a = 0; here.parts && a < here.parts->size(); ++a)
            for (int voxel = 0; voxel < 512; ++voxel)
                if (has((*here.parts)[a].voxels, voxel) &&
                    !inside.isInside(origin.offsetBy(voxel >> 6, (voxel >> 3) & 7, voxel & 7))) {
                    join(parent, here.node + static_cast<int>(a), 0);
                    break;
                }
    };
    openvdb::Coord block;
    for (block[0] = box.min().x(); block[0] <= box.max().x(); ++block[0])
        for (block[1] = box.min().y(); block[1] <= box.max().y(); ++block[1])
            for (block[2] = box.min().z(); block[2] <= box.max().z(); ++block[2]) {
                const Side here = sideOf(block);
                joinSides(block, here);
                for (int face = 0; face < 6; ++face) {
                    openvdb::Coord next = block;
                    next[face / 2] += face % 2 ? 1 : -1;
                    if (face % 2 || !box.isInside(next)) // between two blocks from the lower one only
                        joinAcross(here, sideOf(next), face);
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
    for (std::size_t n = 0; n < leaves.size(); ++n)
        for (std::size_t a = 0; a < air[n].parts.size(); ++a)
            if (closed[firstNode[n] + static_cast<int>(a)])
                for (int w = 0; w < 8; ++w)
                    closedAir[n][w] |= air[n].parts[a].voxels[w];
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
