#include "operators/growth/voxel_interface.h"

#include "volume/distance.h"
#include "volume/leaf_lattice.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace patina {

namespace {

constexpr float noVoxel = std::numeric_limits<float>::max();
constexpr float least = 0.02f; // of a voxel: a crossing stays clear of voxel centres
// Of a voxel: half a voxel and a little. Corners and edges of particles are cut by the trilinear field, more than pores
// gain: at this value a layer of BD reads as thick as its particles are (0.943 of it at 0.5, 1.125 at 0.65; cells of
// two and three voxels ask for 0.544 and 0.557).
constexpr float particle = 0.545f;
constexpr float bare = 1e-3f;  // of a voxel: a column that ends no higher is none

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
                        highestSolid = std::max(highestSolid, p);
                        solidTop = std::max(solidTop, end);
                    } else {
                        lowestEmpty = std::min(lowestEmpty, p);
                    }
                }
    }
    bool isMixed() const { return highestSolid > -noVoxel && lowestEmpty < noVoxel; }
};

/// The value of a voxel next to the surface, voxels.
float valueBeside(const Neighbourhood& near, float phi, float c, bool porous) {
    const bool solid = c <= 0.f;
    const auto apart = [solid](float value) { return solid ? std::min(value, -least) : std::max(value, least); };
    if (porous) {
        if (near.highestSolid < near.lowestEmpty)
            return near.solidTop < bare ? phi : apart(phi - near.solidTop);
        return solid ? -particle : 0.5f;
    }
    if (near.top < bare && near.bottom > -bare)
        return phi;
    if (phi - c < bare && std::abs(c) <= 1.f)
        return phi; // bare beside a column
    if (near.top - near.bottom < 1.f)
        return apart(c);
    return std::abs(c) <= 1.f ? apart(c) : solid ? -0.5f : 0.5f;
}

} // namespace

openvdb::FloatGrid::Ptr interfaceOfVoxels(const openvdb::FloatGrid& surface, const openvdb::FloatGrid& offsets,
                                          double voxelSizeUnits, bool porous, const Progress& progress) {
    const auto voxelSize = static_cast<float>(voxelSizeUnits);
    const auto phiLeaves = leavesOf(surface.tree());
    const auto offsetLeaves = leavesOf(offsets.tree());
    const LeafLattice lattice(phiLeaves);

    // The voxels beside the surface have their values; the others know their side, and have a distance only in name.
    auto grown = surface.deepCopy();
    const auto grownLeaves = leavesOf(grown->tree());
    std::vector<std::array<std::uint64_t, 8>> beside(phiLeaves.size());
    std::vector<char> hasSurface(phiLeaves.size(), 0);
    tbb::enumerable_thread_specific<std::array<PaddedLeaf, 2>> padded;
    tbb::parallel_for(std::size_t(0), phiLeaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        auto& [phi, offset] = padded.local();
        offset.gather(lattice, offsetLeaves, n, 1.f);
        beside[n].fill(0);
        bool anySolid = false, anyEmpty = false;
        for (const float c : offset.values) {
            anySolid |= c <= 0.f;
            anyEmpty |= c > 0.f && c != noVoxel;
        }
        const bool mixed = anySolid && anyEmpty;
        if (mixed)
            phi.gather(lattice, phiLeaves, n, 1.f / voxelSize);
        float* values = grownLeaves[n]->buffer().data();
        forActive(*phiLeaves[n], [&](openvdb::Index pos) {
            const std::size_t centre = PaddedLeaf::at(pos);
            const float c = offset.values[centre];
            if (mixed) {
                const Neighbourhood near(phi, offset, centre);
                if (near.isMixed()) {
                    const float value = valueBeside(near, phi.values[centre], c, porous) * voxelSize;
                    values[pos] = value == phi.values[centre] * voxelSize ? values[pos] : value;
                    beside[n][pos >> 6] |= std::uint64_t(1) << (pos & 63);
                    hasSurface[n] = 1;
                    return;
                }
            }
            values[pos] = std::copysign(std::clamp(std::abs(c), 1.f, 1.5f), c <= 0.f ? -1.f : 1.f) * voxelSize;
        });
    });
    progress.checkpoint();
    if (std::find(hasSurface.begin(), hasSurface.end(), 1) == hasSurface.end())
        return surface.deepCopy();

    // Distances are sought to a level a hair off zero: the sharp creases that belong to level zero alone would take
    // most of the time among the corners of particles, and mean nothing there.
    const DistanceTransform transform(*grown, voxelSizeUnits, porous ? 1e-5 * voxelSizeUnits : 0.0);
    progress.checkpoint();
    // Where nothing was put, phi_n keeps its bits: a distance found anew is off by the chord of a curved surface.
    const float slack = 1e-2f * voxelSize;
    auto result = surface.deepCopy();
    const auto resultLeaves = leavesOf(result->tree());
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), resultLeaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        std::uint64_t wanted[8] = {};
        bool any = false;
        const FloatLeaf& leaf = *phiLeaves[n];
        forActive(leaf, [&](openvdb::Index pos) {
            const std::uint64_t bit = std::uint64_t(1) << (pos & 63);
            if (!(beside[n][pos >> 6] & bit)) {
                wanted[pos >> 6] |= bit;
                any = true;
            }
        });
        const openvdb::Coord block(leaf.origin() >> 3);
        NearestInBlock& near = scratch.local();
        if (any) {
            SearchWindow window;
            window.mask = wanted;
            transform.nearest(block, window, near);
        }
        const float* side = grownLeaves[n]->buffer().data();
        float* values = resultLeaves[n]->buffer().data();
        forActive(leaf, [&](openvdb::Index pos) {
            if (!(wanted[pos >> 6] >> (pos & 63) & 1)) {
                values[pos] = std::min(values[pos], side[pos]);
                return;
            }
            float value = side[pos];
            if (near.point[pos] >= 0)
                value = std::copysign(
                    transform.toFoot(block, static_cast<int>(pos), near.point[pos]).length() * voxelSize, side[pos]);
            if (value < values[pos] - slack)
                values[pos] = value;
        });
    });
    progress.checkpoint();
    return result;
}

} // namespace patina
