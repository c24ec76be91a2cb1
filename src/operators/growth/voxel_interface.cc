#include "operators/growth/voxel_interface.h"

#include "operators/growth/grown_surface.h"
#include "volume/leaf_lattice.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace patina {

namespace {

constexpr float noVoxel = std::numeric_limits<float>::max();
constexpr float least = 0.02f; // of a voxel: a crossing stays clear of voxel centres
constexpr float bare = 1e-3f;  // of a voxel: a column that ends no higher is none

/// How deep a solid voxel of a porous layer lies, voxels, by how much of what is around it is solid (64ths; itself 8,
/// its neighbours 4, 2 and 1). The trilinear field cuts corners and edges of particles: a single voxel at 0.5 would
/// read as 0.27 of itself, a column as 0.6. Exact for those would be 1.2 and 0.8; the curve through them and 0.5 for a
/// plane, fitted so that layers of BD of cells of one, two and three voxels, on a plate and turned out of the voxels'
/// axes, read as thick as their particles are (one value for all reads 8 % too little of single voxels where larger
/// cells are right).
float particleDepth(int solidAround) {
    const float missing = std::max(0.f, 0.75f - static_cast<float>(solidAround) / 64.f);
    return std::min(1.2f, 0.515f + 2.25f * missing * missing * missing);
}

/// A leaf's values with one voxel around it, 10³ of them; noVoxel outside the band.
struct PaddedLeaf {
    std::array<float, 1000> values;

    void gather(const LeafLattice& lattice, const std::vector<const FloatLeaf*>& leaves, std::size_t n, float scale) {
        const openvdb::Coord block(leaves[n]->origin() >> 3);
        const FloatLeaf* around[27];
        for (int i = 0; i < 27; ++i) {
            const std::int32_t number =
                lattice.at(block.x() + i / 9 - 1, block.y() + i / 3 % 3 - 1, block.z() + i % 3 - 1);
            around[i] = number < 0 ? nullptr : leaves[std::size_t(number)];
        }
        for (int x = 0; x < 10; ++x)
            for (int y = 0; y < 10; ++y)
                for (int z = 0; z < 10; ++z) {
                    const FloatLeaf* leaf = around[(x + 7) / 8 * 9 + (y + 7) / 8 * 3 + (z + 7) / 8];
                    const auto pos =
                        static_cast<openvdb::Index>(((x + 7) & 7) << 6 | ((y + 7) & 7) << 3 | ((z + 7) & 7));
                    values[std::size_t(x * 100 + y * 10 + z)] =
                        leaf && leaf->isValueOn(pos) ? leaf->buffer().data()[pos] * scale : noVoxel;
                }
    }
    static std::size_t at(openvdb::Index pos) {
        return std::size_t(((pos >> 6) + 1) * 100 + ((pos >> 3 & 7) + 1) * 10 + (pos & 7) + 1);
    }
};

/// What a voxel's 3x3x3 says about the surface that runs through it.
struct Neighbourhood {
    float highestSolid = -noVoxel; ///< phi_n, voxels
    float lowestEmpty = noVoxel;
    float top = -noVoxel; ///< highest and lowest end of a column
    float bottom = noVoxel;
    float solidTop = -noVoxel; ///< highest end of a column at a solid voxel
    int solidAround = 0;       ///< as particleDepth() wants it

    Neighbourhood(const PaddedLeaf& phi, const PaddedLeaf& offset, std::size_t centre) {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const std::size_t i = centre + std::size_t(x * 100 + y * 10 + z);
                    const float c = offset.values[i], p = phi.values[i];
                    if (c == noVoxel)
                        continue;
                    const float end = p - c;
                    top = std::max(top, end);
                    bottom = std::min(bottom, end);
                    if (c <= 0.f) {
                        solidAround += (2 - std::abs(x)) * (2 - std::abs(y)) * (2 - std::abs(z));
                        highestSolid = std::max(highestSolid, p);
                        solidTop = std::max(solidTop, end);
                    } else {
                        lowestEmpty = std::min(lowestEmpty, p);
                    }
                }
    }
    bool isMixed() const { return highestSolid > -noVoxel && lowestEmpty < noVoxel; }
};

/// The value of a voxel next to the surface, voxels; 0 where it is a particle's or a pore's, which their side and
/// neighbours tell.
float valueBeside(const Neighbourhood& near, float phi, float c, bool porous) {
    const bool solid = c <= 0.f;
    const auto apart = [solid](float value) { return solid ? std::min(value, -least) : std::max(value, least); };
    if (porous) {
        if (near.highestSolid < near.lowestEmpty)
            return near.solidTop < bare ? phi : apart(phi - near.solidTop);
        if (solid && phi <= 0.f)
            return phi; // what the layer stands on
        // Beside low pores, whose value is their height, particles as low weigh no more.
        if (!solid || phi > 1.f + bare)
            return 0.f;
        // A particle reaches half a voxel above its centre, and those that stand on the metal begin there, not half a
        // voxel below: in a crowd they are made as much thinner as they are too high; a lone column (28 and less
        // around) reads as its volume already. Fitted to layers of one to seven voxels on a plate.
        const float tooHigh = std::max(0.f, 0.5f + c);
        const float crowd = std::clamp(static_cast<float>(near.solidAround - 28) / 12.f, 0.f, 1.f);
        return apart(-std::min(phi, 1.f) * (1.f - 0.55f * tooHigh * crowd) * particleDepth(near.solidAround));
    }
    if (near.top < bare && near.bottom > -bare)
        return phi;
    if (phi - c < bare && std::abs(c) <= 1.f)
        return phi; // bare beside a column
    if (near.top - near.bottom < 1.f)
        return apart(c);
    return std::abs(c) <= 1.f ? apart(c) : solid ? -0.5f : 0.5f;
}

bool holds(const VoxelMask& mask, openvdb::Index pos) {
    return mask[pos >> 6] >> (pos & 63) & 1;
}

/// The voxels of a leaf that lie beside the surface.
struct BesideSurface {
    VoxelMask voxels{};
    VoxelMask porous{};                    ///< those of them that are particles or pores
    std::vector<float> values;             ///< of the others, scene units, in order
    std::vector<std::uint8_t> solidAround; ///< of the particles, in order
};

/// Cells near voxels that ask for a distance: the surface within a porous layer is nobody's nearest, and its points
/// would take more memory than the whole band.
std::vector<VoxelMask> cellsNearOthers(const std::vector<const FloatLeaf*>& leaves, const LeafLattice& lattice,
                                       const std::vector<BesideSurface>& beside) {
    std::vector<VoxelMask> cells(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        // Rows along z of the leaf and four voxels around it: bit 4 is z = 0.
        std::uint32_t rows[16][16] = {}, wider[16][16] = {};
        const openvdb::Coord block(leaves[n]->origin() >> 3);
        for (int around = 0; around < 27; ++around) {
            const int a = around / 9 - 1, b = around / 3 % 3 - 1, c = around % 3 - 1;
            const std::int32_t number = lattice.at(block.x() + a, block.y() + b, block.z() + c);
            if (number < 0)
                continue;
            const FloatLeaf& leaf = *leaves[std::size_t(number)];
            for (int x = std::max(0, -4 - 8 * a); x < std::min(8, 12 - 8 * a); ++x) {
                const std::uint64_t others = leaf.getValueMask().getWord<std::uint64_t>(openvdb::Index(x)) &
                                             ~beside[std::size_t(number)].voxels[std::size_t(x)];
                for (int y = std::max(0, -4 - 8 * b); y < std::min(8, 12 - 8 * b); ++y) {
                    const auto row = static_cast<std::uint32_t>(others >> (8 * y) & 0xff);
                    rows[x + 8 * a + 4][y + 8 * b + 4] |= c < 0 ? row >> 4 : row << (4 + 8 * c);
                }
            }
        }
        for (auto& plane : rows)
            for (std::uint32_t& row : plane)
                for (int i = 0; i < 4; ++i)
                    row |= row << 1 | row >> 1;
        for (int x = 0; x < 16; ++x)
            for (int y = 4; y < 12; ++y)
                for (int i = -4; i < 4; ++i)
                    wider[x][y] |= rows[x][y + i] | rows[x][y + i + 1];
        for (int x = 0; x < 8; ++x) {
            std::uint64_t word = 0;
            for (int y = 0; y < 8; ++y) {
                std::uint32_t row = 0;
                for (int i = 0; i <= 8; ++i)
                    row |= wider[x + i][y + 4];
                word |= std::uint64_t(row >> 4 & 0xff) << (8 * y);
            }
            cells[n][std::size_t(x)] = word;
        }
    });
    return cells;
}

} // namespace

void interfaceOfVoxels(const openvdb::FloatGrid& surface, openvdb::FloatGrid& grid, double voxelSizeUnits, bool porous,
                       const Progress& progress) {
    const auto voxelSize = static_cast<float>(voxelSizeUnits);
    const auto phiLeaves = leavesOf(surface.tree());
    const auto leaves = leavesOf(grid.tree());
    const std::vector<const FloatLeaf*> offsetLeaves(leaves.begin(), leaves.end());
    const LeafLattice lattice(phiLeaves);

    std::vector<BesideSurface> beside(phiLeaves.size());
    std::vector<char> hasSurface(phiLeaves.size(), 0);
    tbb::enumerable_thread_specific<std::array<PaddedLeaf, 2>> padded;
    tbb::parallel_for(std::size_t(0), phiLeaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        auto& [phi, offset] = padded.local();
        offset.gather(lattice, offsetLeaves, n, 1.f);
        bool anySolid = false, anyEmpty = false;
        for (const float c : offset.values) {
            anySolid |= c <= 0.f;
            anyEmpty |= c > 0.f && c != noVoxel;
        }
        if (!anySolid || !anyEmpty)
            return;
        phi.gather(lattice, phiLeaves, n, 1.f / voxelSize);
        const float* phiValues = phiLeaves[n]->buffer().data();
        BesideSurface& here = beside[n];
        forActive(*phiLeaves[n], [&](openvdb::Index pos) {
            const std::size_t centre = PaddedLeaf::at(pos);
            const Neighbourhood near(phi, offset, centre);
            if (!near.isMixed())
                return;
            const float c = offset.values[centre], p = phi.values[centre];
            const float value = valueBeside(near, p, c, porous);
            const std::uint64_t bit = std::uint64_t(1) << (pos & 63);
            here.voxels[pos >> 6] |= bit;
            if (porous && value == 0.f && p > 0.f) {
                here.porous[pos >> 6] |= bit;
                if (c <= 0.f)
                    here.solidAround.push_back(static_cast<std::uint8_t>(near.solidAround));
            } else {
                here.values.push_back(value == p ? phiValues[pos] : value * voxelSize);
            }
        });
        here.values.shrink_to_fit();
        here.solidAround.shrink_to_fit();
        hasSurface[n] = !here.values.empty() ||
                        std::any_of(here.voxels.begin(), here.voxels.end(), [](std::uint64_t w) { return w != 0; });
    });
    progress.checkpoint();
    const bool anySurface = std::find(hasSurface.begin(), hasSurface.end(), 1) != hasSurface.end();

    // The voxels beside the surface get their values; the others know their side, and have a distance only in name.
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        const float* phi = phiLeaves[n]->buffer().data();
        float* values = leaves[n]->buffer().data();
        std::size_t next = 0, nextParticle = 0;
        forActive(*phiLeaves[n], [&](openvdb::Index pos) {
            const float c = values[pos];
            if (!anySurface)
                values[pos] = phi[pos];
            else if (!holds(beside[n].voxels, pos))
                values[pos] = std::copysign(std::clamp(std::abs(c), 1.f, 1.5f), c <= 0.f ? -1.f : 1.f) * voxelSize;
            else if (!holds(beside[n].porous, pos))
                values[pos] = std::min(phi[pos], beside[n].values[next++]);
            else
                values[pos] = std::min(
                    phi[pos], voxelSize * (c > 0.f ? 0.5f : -particleDepth(beside[n].solidAround[nextParticle++])));
        });
        std::vector<float>().swap(beside[n].values);
        std::vector<std::uint8_t>().swap(beside[n].solidAround);
    });
    if (!anySurface)
        return;

    std::vector<VoxelMask> cells;
    if (porous)
        cells = cellsNearOthers(phiLeaves, lattice, beside);
    const GrownSurface grown(grid, surface, voxelSizeUnits, porous ? &cells : nullptr);
    std::vector<VoxelMask>().swap(cells);
    progress.checkpoint();
    // A distance found anew is off by the chord of a curved surface.
    const float slack = 1e-2f * voxelSize;
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        const FloatLeaf& leaf = *phiLeaves[n];
        VoxelMask wanted{};
        bool any = false;
        for (openvdb::Index w = 0; w < 8; ++w) {
            wanted[w] = leaf.getValueMask().getWord<std::uint64_t>(w) & ~beside[n].voxels[w];
            any |= wanted[w] != 0;
        }
        const openvdb::Coord block(leaf.origin() >> 3);
        NearestInBlock& near = scratch.local();
        if (any) {
            SearchWindow window;
            window.mask = wanted.data();
            grown.nearest(block, window, near);
        }
        const float* phi = leaf.buffer().data();
        float* values = leaves[n]->buffer().data();
        forActive(leaf, [&](openvdb::Index pos) {
            if (!holds(wanted, pos))
                return;
            float value = values[pos];
            if (near.point[pos] >= 0) {
                bool bare = false;
                const float distance = grown.distance(block, static_cast<int>(pos), near.point[pos], bare);
                // Where nothing was put, phi_n keeps its bits: it is the better distance.
                value =
                    bare && (phi[pos] <= 0.f) == (value <= 0.f) ? phi[pos] : std::copysign(distance * voxelSize, value);
            }
            values[pos] = value < phi[pos] - slack ? value : phi[pos];
        });
    });
    progress.checkpoint();
}

} // namespace patina
