#include "volume/closing_balls.h"

#include "volume/half_spaces.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr float shellWidth = 1.9f; // a cell that {D = r} crosses has its corners within sqrt(3) of it

} // namespace

bool ClosingBalls::Patches::holds(std::int32_t s) const {
    return std::find(seed.begin(), seed.begin() + count, s) != seed.begin() + count;
}

bool ClosingBalls::addPatch(const openvdb::Coord& block, std::int32_t seed, Patches& patches) const {
    if (seed < 0 || patches.count == HalfSpaces::most || patches.holds(seed))
        return false;
    patches.seed[patches.count] = seed;
    patches.point[patches.count++] = surface_.seeds().points.from(block, seed);
    return true;
}

ClosingBalls::ClosingBalls(const DistanceTransform& surface, const SurfaceContacts& contacts, double radius,
                           bool fromOutside, Progress& progress)
    : surface_(surface), contact_(contacts), radius_(static_cast<float>(radius)), fromOutside_(fromOutside) {
    findShell(progress);
    if (fromOutside)
        keepReachable();
    placeCentres(progress);
}

void ClosingBalls::findShell(Progress& progress) {
    const PointBlocks& points = surface_.seeds().points;
    const int reach = static_cast<int>(std::ceil((radius_ + shellWidth) / 8.f)) + 1;
    openvdb::CoordBBox box = points.lattice.box();
    box.expand(reach);
    lattice_ = BlockBox(box);
    for (const PointBlocks::Block& block : points.blocks)
        lattice_.set(block.block, 0);
    widenMarks(lattice_, reach);
    std::vector<std::size_t> slots;
    for (std::size_t s = 0; s < lattice_.numbers().size(); ++s)
        if (lattice_.numbers()[s] >= 0)
            slots.push_back(s);

    const LevelSetBlocks& levelSet = surface_.levelSet();
    // Further away there is neither surface nor shell: free outside, blocked inside.
    tbb::parallel_for(std::size_t(0), lattice_.numbers().size(), [&](std::size_t s) {
        if (lattice_.numbers()[s] < 0) {
            const openvdb::Coord block = lattice_.blockOf(s);
            const FloatLeaf* leaf = levelSet.leafAt(block);
            lattice_.numbers()[s] =
                (leaf ? leaf->buffer().data()[0] : levelSet.fillAt(block)) > 0.f ? freeBlock : blocked;
        }
    });

    SearchWindow window;
    window.nearest = std::max(0.f, radius_ - shellWidth);
    window.furthest = radius_ + shellWidth;
    tbb::enumerable_thread_specific<NearestInBlock> scratch;
    // In runs, so that only what is kept takes memory.
    constexpr std::size_t run = 4096;
    std::vector<ShellBlock> some(std::min(run, slots.size()));
    std::vector<std::int32_t> state(some.size());
    for (std::size_t first = 0; first < slots.size(); first += run) {
        const std::size_t count = std::min(run, slots.size() - first);
        tbb::parallel_for(std::size_t(0), count, [&](std::size_t n) {
            ShellBlock& shell = some[n];
            shell.block = lattice_.blockOf(slots[first + n]);
            state[n] = blocked;
            const FloatLeaf* leaf = levelSet.leafAt(shell.block);
            if ((!leaf && levelSet.fillAt(shell.block) < 0.f) || progress.cancelled())
                return;
            std::uint64_t outside[8];
            std::fill(outside, outside + 8, ~std::uint64_t(0));
            if (leaf)
                for (int pos = 0; pos < 512; ++pos)
                    if (!(leaf->buffer().data()[pos] > 0.f))
                        outside[pos >> 6] &= ~(std::uint64_t(1) << (pos & 63));
            NearestInBlock& near = scratch.local();
            SearchWindow here = window;
            here.mask = outside;
            surface_.nearest(shell.block, here, near);
            bool further = false;
            for (int pos = 0; pos < 512; ++pos) {
                if (!(outside[pos >> 6] >> (pos & 63) & 1))
                    near.point[pos] = NearestInBlock::closer;
                further |= near.point[pos] == NearestInBlock::further;
            }
            if (near.any) {
                shell.seed = near.point;
                state[n] = 0;
            } else if (further) {
                state[n] = freeBlock;
            }
        });
        progress.checkpoint();
        for (std::size_t n = 0; n < count; ++n) {
            lattice_.numbers()[slots[first + n]] = state[n] < 0 ? state[n] : static_cast<std::int32_t>(shell_.size());
            if (state[n] >= 0)
                shell_.push_back(some[n]);
        }
    }
}

std::int32_t ClosingBalls::seedAt(const openvdb::Coord& voxel) const {
    const std::int32_t number = lattice_.at(voxel >> 3);
    if (number >= 0)
        return shell_[number].seed[64 * (voxel.x() & 7) + 8 * (voxel.y() & 7) + (voxel.z() & 7)];
    return number == freeBlock ? NearestInBlock::further : NearestInBlock::closer;
}

bool ClosingBalls::addPatches(const openvdb::Coord& block, const Imath::V3f& point, Patches& patches) const {
    const openvdb::Coord cell(8 * block.x() + int(std::floor(point.x)), 8 * block.y() + int(std::floor(point.y)),
                              8 * block.z() + int(std::floor(point.z)));
    if (cell == patches.cell)
        return false;
    patches.cell = cell;
    bool added = false;
    std::int32_t last = -1;
    for (int n = 0; n < 8; ++n) {
        const std::int32_t seed = seedAt(cell.offsetBy(n >> 2, (n >> 1) & 1, n & 1));
        if (seed != last)
            added |= addPatch(block, seed, patches);
        last = seed;
    }
    return added;
}

float ClosingBalls::clearance(const Imath::V3f& point, const Patches& patches) const {
    float least = std::numeric_limits<float>::max();
    for (int i = 0; i < patches.count; ++i) {
        const Imath::V3f away = fromFoot(patches, i, point);
        least = std::min(least, away.dot(away));
    }
    return std::sqrt(least);
}

bool ClosingBalls::place(const openvdb::Coord& block, const Imath::V3f& x, Patches& patches, Imath::V3f& centre,
                         bool mayAdd) const {
    const Imath::V3f start = centre;
    HalfSpaces spaces;
    for (int iteration = 0; iteration < 6; ++iteration) {
        // Each patch keeps the ball's centre on the far side of a plane: D_i + n_i · (c - centre) >= r.
        spaces.count = 0;
        for (int i = 0; i < patches.count; ++i) {
            Imath::V3f n = fromFoot(patches, i, centre);
            const float d = n.length();
            if (!(d > 1e-4f))
                continue;
            n /= d;
            spaces.normal[spaces.count] = n;
            spaces.offset[spaces.count++] = n.dot(centre) + radius_ - d;
        }
        Imath::V3f next = spaces.closestTo(x);
        Imath::V3f step = next - centre;
        const float moved = step.length();
        if (moved > 1.5f)
            next = centre + step * (1.5f / moved);
        centre = next;
        const bool added = mayAdd && addPatches(block, centre, patches);
        // The planes stand for surfaces no more bent than the ball, nearly always: after a step of m they are out by m²
        // / 2r.
        if (moved < 0.1f && !added)
            return spaces.lackingAt(centre) < 0.1f;
        const Imath::V3f gone = centre - start;
        if (gone.dot(gone) > 9.f)
            return false;
    }
    return clearance(centre, patches) > radius_ - 0.1f;
}

float ClosingBalls::distance(const openvdb::Coord& block, const Imath::V3f& x, std::int32_t start) const {
    const Imath::V3f first = centres_.from(block, start);
    Imath::V3f centre = first;
    Patches patches;
    addPatches(block, centre, patches);
    const float nearest = (x - first).length();
    if (!place(block, x, patches, centre, true))
        return nearest;
    return std::min(nearest, (x - centre).length());
}

void ClosingBalls::dropOpen(const openvdb::Coord& block, std::uint64_t* voxels) const {
    const std::int32_t number = lattice_.holds(block) ? lattice_.at(block) : freeBlock;
    if (number == freeBlock)
        std::fill(voxels, voxels + 8, std::uint64_t(0));
    for (int pos = 0; number >= 0 && pos < 512; ++pos)
        if (shell_[number].seed[pos] == NearestInBlock::further)
            voxels[pos >> 6] &= ~(std::uint64_t(1) << (pos & 63));
}

bool ClosingBalls::touches(std::int32_t seed, std::int32_t& guess) const {
    const PointBlocks& points = surface_.seeds().points;
    const Imath::V3f point(points.x[seed], points.y[seed], points.z[seed]);
    const openvdb::Coord& block = points.blocks[points.blockOf[seed]].block;
    return touches(block, surface_.seeds().pointUnder(block, point, seed), guess);
}

bool ClosingBalls::touches(const openvdb::Coord& block, const TouchPoint& point, std::int32_t& guess) const {
    for (int i = 0; i < point.count; ++i)
        if (fits(block, point.foot + point.normals[i] * radius_, guess))
            return true;
    return false;
}

bool ClosingBalls::fits(const openvdb::Coord& block, const Imath::V3f& centre, std::int32_t& guess) const {
    if (fromOutside_) {
        const openvdb::Coord cell(8 * block.x() + int(std::floor(centre.x)), 8 * block.y() + int(std::floor(centre.y)),
                                  8 * block.z() + int(std::floor(centre.z)));
        bool reached = false;
        for (int n = 0; n < 8 && !reached; ++n) {
            const openvdb::Coord corner = cell.offsetBy(n >> 2, (n >> 1) & 1, n & 1);
            const std::int32_t number = lattice_.at(corner >> 3);
            reached =
                number >= 0 && (reachable_[number][corner.x() & 7] >> (8 * (corner.y() & 7) + (corner.z() & 7)) & 1);
        }
        if (!reached)
            return false;
    }
    return contact_.isClear(block, centre, radius_ - contactTolerance, guess);
}

void ClosingBalls::centresOfBlock(std::size_t n, std::vector<Imath::V3f>& found) const {
    const openvdb::Coord block = shell_[n].block;
    constexpr int side = 9;
    std::array<std::int32_t, side * side * side> seed;
    std::array<float, side * side * side> d;
    std::array<std::uint8_t, side * side * side> reached;
    for (int i = 0, at = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            for (int k = 0; k < side; ++k, ++at) {
                const openvdb::Coord voxel = (block << 3).offsetBy(i, j, k);
                seed[at] = seedAt(voxel);
                const Imath::V3f x{float(i), float(j), float(k)};
                d[at] = seed[at] >= 0 ? (x - surface_.seeds().footOf(block, x, seed[at])).length()
                        : seed[at] == NearestInBlock::closer ? 0.f
                                                             : radius_ + shellWidth;
                reached[at] = 1;
                if (fromOutside_) {
                    const std::int32_t number = lattice_.at(voxel >> 3);
                    reached[at] = number >= 0
                                      ? reachable_[number][voxel.x() & 7] >> (8 * (voxel.y() & 7) + (voxel.z() & 7)) & 1
                                      : 0;
                }
            }
    static constexpr int edges[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                                         {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
            for (int k = 0; k < 8; ++k) {
                int corner[8];
                float c[8], least = std::numeric_limits<float>::max(), most = 0.f;
                bool near = false, open = false;
                for (int v = 0; v < 8; ++v) {
                    corner[v] = ((i + (v >> 2)) * side + j + ((v >> 1) & 1)) * side + k + (v & 1);
                    c[v] = d[corner[v]];
                    least = std::min(least, c[v]);
                    most = std::max(most, c[v]);
                    near |= seed[corner[v]] >= 0;
                    open |= reached[corner[v]] != 0;
                }
                if (!near || !open || least >= radius_ || most < radius_ - 0.87f)
                    continue;
                const Imath::V3f origin{float(i), float(j), float(k)};
                if (most >= radius_) {
                    Imath::V3f sum(0.f);
                    int crossed = 0;
                    for (const auto& edge : edges) {
                        const float a = c[edge[0]] - radius_, b = c[edge[1]] - radius_;
                        if ((a < 0.f) == (b < 0.f))
                            continue;
                        const Imath::V3f from(float(edge[0] >> 2), float((edge[0] >> 1) & 1), float(edge[0] & 1)),
                            to(float(edge[1] >> 2), float((edge[1] >> 1) & 1), float(edge[1] & 1));
                        sum += from + (to - from) * (a / (a - b));
                        ++crossed;
                    }
                    found.push_back(origin + sum / float(crossed));
                    continue;
                }
                // No corner is free, but there may be room between: the tip of a wedge, or a gap hardly wider than the
                // ball. Only where patches of different directions meet.
                Patches patches;
                Imath::V3f first(0.f);
                bool differ = false;
                const Imath::V3f middle = origin + Imath::V3f(0.5f);
                for (int v = 0; v < 8; ++v) {
                    if (!addPatch(block, seed[corner[v]], patches))
                        continue;
                    const Imath::V3f n = fromFoot(patches, patches.count - 1, middle).normalized();
                    if (patches.count == 1)
                        first = n;
                    differ |= n.dot(first) < 0.95f;
                }
                if (!differ)
                    continue;
                Imath::V3f centre = middle;
                if (!place(block, middle, patches, centre, false))
                    continue;
                const Imath::V3f off = centre - middle;
                if (std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= 0.55f)
                    found.push_back(Imath::V3f(std::clamp(centre.x, origin.x, origin.x + 0.9999f),
                                               std::clamp(centre.y, origin.y, origin.y + 0.9999f),
                                               std::clamp(centre.z, origin.z, origin.z + 0.9999f)));
            }
}

void ClosingBalls::placeCentres(Progress& progress) {
    std::vector<std::vector<Imath::V3f>> found(shell_.size());
    tbb::parallel_for(std::size_t(0), shell_.size(), [&](std::size_t n) {
        if (!progress.cancelled())
            centresOfBlock(n, found[n]);
    });
    progress.checkpoint();
    std::vector<std::size_t> start(shell_.size() + 1, 0);
    openvdb::CoordBBox box;
    for (std::size_t n = 0; n < shell_.size(); ++n) {
        start[n + 1] = start[n] + found[n].size();
        if (!found[n].empty())
            box.expand(shell_[n].block);
    }
    centres_.lattice = BlockBox(box);
    centres_.resize(start.back());
    for (std::size_t n = 0; n < shell_.size(); ++n)
        if (!found[n].empty()) {
            const auto number = static_cast<std::uint32_t>(centres_.blocks.size());
            centres_.lattice.set(shell_[n].block, static_cast<std::int32_t>(number));
            centres_.blocks.push_back(
                {shell_[n].block, static_cast<std::uint32_t>(start[n]), static_cast<std::uint32_t>(start[n + 1])});
            for (std::size_t i = 0; i < found[n].size(); ++i) {
                centres_.x[start[n] + i] = found[n][i].x;
                centres_.y[start[n] + i] = found[n][i].y;
                centres_.z[start[n] + i] = found[n][i].z;
                centres_.blockOf[start[n] + i] = number;
            }
        }
}

} // namespace patina
