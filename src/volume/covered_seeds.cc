#include "volume/covered_seeds.h"

#include "volume/leaf_lattice.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace patina {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

// A film beside a sharp convex edge counts if it is connected (block by block) to one elsewhere, or to one that is
// thicker than this (voxels): along such edges, which the voxels only know to some hundredths, there are films of
// nothing.
constexpr float surelyFilm = 0.12f;
// What a film counts at least where the balls do not touch.
constexpr float faintest = 1e-6f;

// Takes back what is covered in blocks from which no way through such blocks leads to a sure film.
void dropFaintFilms(const PointBlocks& points, const std::vector<float>& thickest, std::vector<std::uint8_t>& covered) {
    std::vector<std::uint8_t> kept(points.blocks.size(), 0);
    std::vector<std::int32_t> front;
    for (std::size_t b = 0; b < kept.size(); ++b)
        if (thickest[b] > surelyFilm) {
            kept[b] = 1;
            front.push_back(static_cast<std::int32_t>(b));
        }
    while (!front.empty()) {
        const openvdb::Coord block = points.blocks[front.back()].block;
        front.pop_back();
        for (int n = 0; n < 27; ++n) {
            const std::int32_t next = points.lattice.at(block.offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
            if (next >= 0 && !kept[next] && thickest[next] > 0.f) {
                kept[next] = 1;
                front.push_back(next);
            }
        }
    }
    for (std::size_t b = 0; b < kept.size(); ++b)
        if (!kept[b])
            std::fill(covered.begin() + points.blocks[b].begin, covered.begin() + points.blocks[b].end,
                      std::uint8_t(0));
}

// Seeds within three cells of a sharp convex edge.
std::vector<std::uint8_t> besideEdges(const SurfaceSeeds& seeds) {
    std::vector<std::uint8_t> sharp(seeds.patches.size());
    for (std::size_t s = 0; s < sharp.size(); ++s) {
        const SurfacePatch& patch = seeds.patches[s];
        sharp[s] = (patch.crease && patch.convex) ||
                   (!patch.crease && patch.bentness() > 0.2f && patch.shape[0] + patch.shape[3] + patch.shape[5] > 0.f);
    }
    return withNeighbours(seeds.points, withNeighbours(seeds.points, withNeighbours(seeds.points, sharp)));
}

// For every seed: whether some ball that should touch it, or a surface voxel's foot on its patch, does not.
std::vector<std::uint8_t> untouchedSeeds(const DistanceTransform& surface, const ClosingBalls& balls, double voxelSize,
                                         Progress& progress) {
    // The nearer end of a lattice edge that the surface crosses is within half a voxel of it.
    const auto nearSurface = static_cast<float>(0.55 * voxelSize);
    const PointBlocks& points = surface.seeds().points;
    const auto& leaves = surface.levelSet().leaves();
    std::vector<std::uint8_t> untouched(points.size(), 0);
    std::vector<std::vector<std::int32_t>> elsewhere(leaves.size()); ///< seeds of other blocks
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        const FloatLeaf& leaf = *leaves[n];
        const openvdb::Coord block(leaf.origin() >> 3);
        const float* phi = leaf.buffer().data();
        VoxelMask close = voxelsWhere([&](unsigned pos) { return std::abs(phi[pos]) <= nearSurface; });
        const VoxelMask active = activeVoxelsOf(leaf);
        for (int w = 0; w < 8; ++w)
            close[w] &= active[w];
        const std::int32_t number = points.lattice.at(block);
        std::uint32_t begin = 0, end = 0;
        if (number >= 0) {
            begin = points.blocks[number].begin;
            end = points.blocks[number].end;
        }
        std::int32_t guess = -1;
        for (std::uint32_t s = begin; s < end; ++s)
            untouched[s] = !balls.touches(static_cast<std::int32_t>(s), guess);
        if (std::all_of(close.begin(), close.end(), [](std::uint64_t word) { return word == 0; }))
            return;
        SearchWindow window;
        window.mask = close.data();
        NearestInBlock& near = scratch.local();
        surface.nearest(block, window, near);
        for (int pos = 0; pos < 512; ++pos) {
            const std::int32_t seed = near.point[pos];
            if (!(close[pos >> 6] >> (pos & 63) & 1) || seed < 0)
                continue;
            const bool own = std::uint32_t(seed) >= begin && std::uint32_t(seed) < end;
            const Imath::V3f x(float(pos >> 6), float((pos >> 3) & 7), float(pos & 7));
            if ((own && untouched[seed]) || balls.touches(block, surface.seeds().pointUnder(block, x, seed), guess))
                continue;
            if (own)
                untouched[seed] = 1;
            else
                elsewhere[n].push_back(seed);
        }
    });
    progress.checkpoint();
    for (const auto& seeds : elsewhere)
        for (const std::int32_t seed : seeds)
            untouched[seed] = 1;
    return untouched;
}

} // namespace

std::vector<std::uint8_t> withNeighbours(const PointBlocks& points, const std::vector<std::uint8_t>& marks) {
    std::vector<std::array<std::uint64_t, 8>> cells(points.blocks.size());
    const auto cellOf = [&](std::uint32_t s) {
        const auto at = [](float v) { return std::clamp(int(std::floor(v)), 0, 7); };
        return openvdb::Coord(at(points.x[s]), at(points.y[s]), at(points.z[s]));
    };
    for (std::size_t b = 0; b < cells.size(); ++b) {
        cells[b].fill(0);
        for (std::uint32_t s = points.blocks[b].begin; s < points.blocks[b].end; ++s)
            if (marks[s]) {
                const openvdb::Coord c = cellOf(s);
                cells[b][c.x()] |= std::uint64_t(1) << (8 * c.y() + c.z());
            }
    }
    std::vector<std::uint8_t> marked = marks;
    tbb::parallel_for(std::size_t(0), cells.size(), [&](std::size_t b) {
        const openvdb::Coord origin = points.blocks[b].block << 3;
        for (std::uint32_t s = points.blocks[b].begin; s < points.blocks[b].end; ++s)
            for (int n = 0; n < 27 && !marked[s]; ++n) {
                const openvdb::Coord c = origin + cellOf(s).offsetBy(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
                const std::int32_t number = points.lattice.at(c >> 3);
                if (number >= 0)
                    marked[s] = cells[number][c.x() & 7] >> (8 * (c.y() & 7) + (c.z() & 7)) & 1;
            }
    });
    return marked;
}

std::vector<std::uint8_t> coveredSeeds(const DistanceTransform& surface, const ClosingBalls& balls,
                                       const NearestPoints& nearestBall, float radius, double voxelSize,
                                       Progress& progress) {
    const PointBlocks& points = surface.seeds().points;
    std::vector<std::uint8_t> covered = untouchedSeeds(surface, balls, voxelSize, progress);
    std::vector<float> thickest(points.blocks.size(), 0.f);
    const std::vector<std::uint8_t> doubtful = besideEdges(surface.seeds());
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t b) {
        if (progress.cancelled())
            return;
        const PointBlocks::Block& block = points.blocks[b];
        std::uint64_t mask[8] = {};
        bool any = false;
        // The corners of a seed's cell that lie in the block: near an edge each may belong to another side of it.
        const auto cornerOf = [&](std::uint32_t s, int n) {
            const auto at = [](float v, int step) { return std::clamp(int(std::floor(v)) + step, 0, 7); };
            return 64 * at(points.x[s], n >> 2) + 8 * at(points.y[s], (n >> 1) & 1) + at(points.z[s], n & 1);
        };
        // How thick its film is matters only where a film may be a false one.
        for (std::uint32_t s = block.begin; s < block.end; ++s) {
            if (!covered[s])
                continue;
            thickest[b] = std::max(thickest[b], doubtful[s] ? faintest : 2.f * surelyFilm);
            if (!doubtful[s])
                continue;
            for (int n = 0; n < 8; ++n)
                mask[cornerOf(s, n) >> 6] |= std::uint64_t(1) << (cornerOf(s, n) & 63);
            any = true;
        }
        if (!any || thickest[b] > surelyFilm)
            return;
        NearestInBlock& near = scratch.local();
        SearchWindow window;
        window.mask = mask;
        window.furthest = 2.f * radius + 8.f;
        nearestBall.search(block.block, window, near);
        for (std::uint32_t s = block.begin; s < block.end; ++s)
            if (covered[s] && doubtful[s]) {
                const Imath::V3f x(points.x[s], points.y[s], points.z[s]);
                std::int32_t centre = -1;
                float least = infinite;
                for (int n = 0; n < 8; ++n) {
                    const std::int32_t candidate = near.point[cornerOf(s, n)];
                    if (candidate < 0)
                        continue;
                    const Imath::V3f apart = balls.centres().from(block.block, candidate) - x;
                    if (apart.dot(apart) < least) {
                        least = apart.dot(apart);
                        centre = candidate;
                    }
                }
                const float film = centre < 0 ? 8.f : balls.distance(block.block, x, centre) - radius;
                // A seed on an edge may lie on a chord below it: what is surely a film is so on the faces beside it
                // too.
                const bool bent = surface.seeds().patches[s].bentness() > 0.3f;
                thickest[b] = std::max(thickest[b], bent ? std::min(film, 0.5f * surelyFilm) : film);
            }
    });
    progress.checkpoint();
    dropFaintFilms(points, thickest, covered);
    return covered;
}

} // namespace patina
