#include "volume/closing.h"

#include "base/errors.h"
#include "volume/band_growth.h"
#include "volume/closing_balls.h"
#include "volume/covered_seeds.h"
#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <Imath/ImathBox.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

namespace patina {

namespace {

struct Film {
    openvdb::Coord block;
    std::array<std::uint64_t, 8> missing; ///< voxels that the band lacks
    std::array<float, 512> level;         ///< of the closed surface, voxels; infinite where there is no film
};

struct Searchers {
    NearestInBlock seeds, balls;
    std::int32_t guess = -1; ///< the seed that last kept a ball from touching
};

constexpr float infinite = std::numeric_limits<float>::infinity();

bool anyOf(const VoxelMask& mask) {
    return std::any_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word != 0; });
}

// Balls fit into hollows, too, but no operator comes there: what faces closed air is left as it is.
// \return whether there is any
bool dropClosedAir(const DistanceTransform& surface, const OpenAir& air, std::vector<std::uint8_t>& covered) {
    if (!air.anyClosed())
        return false;
    const PointBlocks& points = surface.seeds().points;
    const auto near = [](float v) { return static_cast<unsigned>(std::clamp(int(std::lround(v)), 0, 7)); };
    for (const PointBlocks::Block& block : points.blocks) {
        const std::int32_t leaf = surface.levelSet().lattice().at(block.block.x(), block.block.y(), block.block.z());
        for (std::uint32_t s = block.begin; leaf >= 0 && s < block.end; ++s)
            if (air.isSealed(static_cast<std::size_t>(leaf),
                             64 * near(points.x[s]) + 8 * near(points.y[s]) + near(points.z[s])))
                covered[s] = 0;
    }
    return true;
}

// Marks the blocks with a voxel that may be nearer than `distance` to a covered seed of this block.
void markAround(const PointBlocks& points, const PointBlocks::Block& block, const std::vector<std::uint8_t>& covered,
                int reach, float distance, BlockBox& marks) {
    Imath::Box3f box;
    for (std::uint32_t s = block.begin; s < block.end; ++s)
        if (covered[s])
            box.extendBy(Imath::V3f(points.x[s], points.y[s], points.z[s]));
    if (box.isEmpty())
        return;
    for (int i = -reach; i <= reach; ++i)
        for (int j = -reach; j <= reach; ++j)
            for (int k = -reach; k <= reach; ++k) {
                const Imath::V3f low(8.f * float(i), 8.f * float(j), 8.f * float(k));
                Imath::V3f apart;
                for (int axis = 0; axis < 3; ++axis)
                    apart[axis] = std::max({0.f, low[axis] - box.max[axis], box.min[axis] - low[axis] - 7.f});
                if (apart.length2() <= distance * distance)
                    marks.set(block.block.offsetBy(i, j, k), 0);
            }
}

} // namespace

Closing closeInterface(LayerVolume& volume, int k, const ClosingOptions& options, Progress& progress) {
    if (!(options.radius > 0.0))
        throw RunError("closing", "the ball's radius must be positive", "give a length of the model, such as 0.2mm");
    NestGrids& grids = volume.grids();
    const double voxelSize = volume.scale().voxelSize;
    const auto radius = static_cast<float>(options.radius / voxelSize),
               margin = static_cast<float>(options.marginVoxels);
    const float leastFilm = contactTolerance * contactTolerance / (2.f * radius);
    const auto source = [&]() -> const openvdb::FloatGrid& {
        return k < 0 ? *grids.base : k == 0 ? grids.floor() : *grids.interfaces[k - 1];
    };

    std::vector<Film> films;
    Closing closing;
    {
        const DistanceTransform surface(source(), voxelSize);
        progress.checkpoint();
        const SurfaceContacts contacts(surface.levelSet(), surface.seeds(), voxelSize);
        const ClosingBalls balls(surface, contacts, radius, options.global, progress);
        const NearestPoints nearestBall(balls.centres());
        std::vector<std::uint8_t> covered = coveredSeeds(surface, balls, nearestBall, radius, voxelSize, progress);
        // A film's voxel is nearer than r to the surface, at a seed that the closing covers or beside one.
        const PointBlocks& points = surface.seeds().points;
        // Between a seed that the balls touch and one that they do not lies the closing's rim: each voxel there is
        // asked for itself.
        covered = withNeighbours(points, covered);
        bool closedAir = false;
        if (options.openAirOnly)
            closedAir = dropClosedAir(surface, OpenAir(volume), covered);
        openvdb::CoordBBox box = points.lattice.box();
        const int reach = static_cast<int>(std::ceil((radius + margin) / 8.f));
        box.expand(reach);
        BlockBox marks(box);
        for (const PointBlocks::Block& block : points.blocks)
            markAround(points, block, covered, reach, radius + margin, marks);
        std::vector<openvdb::Coord> blocks;
        for (std::size_t s = 0; s < marks.numbers().size(); ++s)
            if (marks.numbers()[s] >= 0)
                blocks.push_back(marks.blockOf(s));
        std::vector<std::unique_ptr<Film>> found(blocks.size());
        tbb::enumerable_thread_specific<Searchers> scratch;
        const LevelSetBlocks& levelSet = surface.levelSet();
        const bool askAll = options.global || closedAir;
        tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t n) {
            const openvdb::Coord& block = blocks[n];
            const FloatLeaf* leaf = levelSet.leafAt(block);
            if ((!leaf && levelSet.fillAt(block) < 0.f) || progress.cancelled())
                return;
            VoxelMask wanted, active{};
            wanted.fill(~std::uint64_t(0));
            if (leaf) {
                const float* phi = leaf->buffer().data();
                const VoxelMask air = voxelsWhere([phi](unsigned pos) { return phi[pos] > 0.f; });
                active = activeVoxelsOf(*leaf);
                for (int w = 0; w < 8; ++w)
                    wanted[w] = air[w] | active[w];
            }
            keepWithin(grids.sides, block, wanted.data());
            // Of the band, voxels over covered seeds. Beyond it a film is where the balls are far from, and who covers
            // it matters only where some air is not theirs.
            VoxelMask asked = wanted, filmed{};
            for (int w = 0; w < 8 && !askAll; ++w)
                asked[w] &= active[w];
            Searchers& search = scratch.local();
            SearchWindow window;
            window.mask = asked.data();
            window.furthest = radius + margin;
            window.relevant = covered.data();
            search.seeds.any = false;
            if (anyOf(asked))
                surface.nearest(block, window, search.seeds);
            for (int pos = 0; search.seeds.any && pos < 512; ++pos) {
                const std::uint64_t bit = std::uint64_t(1) << (pos & 63);
                const std::int32_t seed = search.seeds.point[pos];
                if (!(asked[pos >> 6] & bit) || seed < 0 || !covered[seed])
                    continue;
                const Imath::V3f x(float(pos >> 6), float((pos >> 3) & 7), float(pos & 7));
                if (!(active[pos >> 6] & bit) ||
                    !balls.touches(block, surface.seeds().pointUnder(block, x, seed), search.guess))
                    filmed[pos >> 6] |= bit;
            }
            if (!askAll) {
                VoxelMask beyond;
                for (int w = 0; w < 8; ++w)
                    beyond[w] = wanted[w] & ~active[w];
                balls.dropOpen(block, beyond.data());
                for (int w = 0; w < 8; ++w)
                    filmed[w] |= beyond[w];
            }
            if (!anyOf(filmed))
                return;
            SearchWindow around;
            around.mask = filmed.data();
            around.nearest = radius - margin - 1.f;
            around.furthest = 2.f * radius + 8.f;
            nearestBall.search(block, around, search.balls);
            auto film = std::make_unique<Film>();
            film->block = block;
            film->missing.fill(0);
            film->level.fill(infinite);
            bool some = false;
            for (int pos = 0; pos < 512; ++pos) {
                const std::uint64_t bit = std::uint64_t(1) << (pos & 63);
                if (!(filmed[pos >> 6] & bit))
                    continue;
                const std::int32_t centre = search.balls.point[pos];
                if (centre == NearestInBlock::closer)
                    continue; // in the air, far above the film
                const Imath::V3f x(float(pos >> 6), float((pos >> 3) & 7), float(pos & 7));
                const bool isActive = active[pos >> 6] & bit;
                const float here = isActive ? leaf->buffer().data()[pos] / static_cast<float>(voxelSize) : infinite;
                // The ball that is placed comes at least as near as the one found.
                if (!isActive && centre >= 0 && radius - (balls.centres().from(block, centre) - x).length() > margin)
                    continue;
                // What no ball comes near is filled. Where the ball at the point under x would stand in the surface by
                // more than the tolerance t, those that fit stand aside by t at least, so that over a flat place the
                // film is no thinner than t² / 2r, which rounding would lose.
                const float level =
                    centre < 0 ? -radius - 8.f : std::min(radius - balls.distance(block, x, centre), here - leastFilm);
                if (!isActive && level > margin)
                    continue;
                film->level[pos] = level;
                if (!isActive)
                    film->missing[pos >> 6] |= bit;
                some = true;
            }
            if (some)
                found[n] = std::move(film);
        });
        progress.checkpoint();
        for (auto& film : found)
            if (film)
                films.push_back(std::move(*film));
    }
    closing.changed = !films.empty();

    std::vector<BlockMask> missing;
    for (const Film& film : films)
        if (std::any_of(film.missing.begin(), film.missing.end(), [](std::uint64_t word) { return word != 0; }))
            missing.push_back({film.block, film.missing});
    if (!missing.empty()) {
        const double level = baseLevelForGrowth(volume);
        addToBand(volume, missing, DistanceTransform(*grids.base, voxelSize, level), level);
        closing.grewBand = true;
    }

    openvdb::CoordBBox box;
    for (const Film& film : films)
        box.expand(film.block);
    BlockBox filmAt(box);
    for (std::size_t n = 0; n < films.size(); ++n)
        filmAt.set(films[n].block, static_cast<std::int32_t>(n));
    const auto leaves = leavesOf(source().tree());
    std::vector<std::size_t> start(leaves.size() + 1, 0);
    for (std::size_t n = 0; n < leaves.size(); ++n)
        start[n + 1] = start[n] + leaves[n]->onVoxelCount();
    closing.level.resize(start.back());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        const std::int32_t number = films.empty() ? -1 : filmAt.at(openvdb::Coord(leaves[n]->origin() >> 3));
        const float* phi = leaves[n]->buffer().data();
        std::size_t at = start[n];
        forActive(*leaves[n], [&](openvdb::Index pos) {
            const float closed = number < 0 ? infinite : films[number].level[pos] * static_cast<float>(voxelSize);
            closing.level[at++] = std::min(phi[pos], closed);
        });
    });
    return closing;
}

} // namespace patina
