// Which balls of a closing can come from outside.

#include "volume/closing_balls.h"

#include <tbb/parallel_for.h>

namespace patina {

void ClosingBalls::keepReachable() {
    // Free voxels of the shell, then a flood from outside the box; blocks off the shell count as a whole. A way from
    // voxel to voxel strays from the middle of a narrow neck by up to 0.8 voxel: half of that is allowed for.
    constexpr float strays = 0.4f;
    std::vector<std::array<std::uint64_t, 8>> open(shell_.size());
    tbb::parallel_for(std::size_t(0), shell_.size(), [&](std::size_t n) {
        open[n].fill(0);
        for (int pos = 0; pos < 512; ++pos) {
            const std::int32_t seed = shell_[n].seed[pos];
            const bool isOpen = seed == NearestInBlock::further ||
                                (seed >= 0 && surface_.toFoot(shell_[n].block, pos, seed).length() >= radius_ - strays);
            open[n][pos >> 6] |= std::uint64_t(isOpen) << (pos & 63);
        }
    });
    reachable_.assign(shell_.size(), {});
    std::vector<std::uint8_t> reachedBlock(lattice_.numbers().size(), 0);
    std::vector<openvdb::Coord> blocks;
    std::vector<openvdb::Coord> voxels;
    const openvdb::CoordBBox& box = lattice_.box();
    const auto enterBlock = [&](const openvdb::Coord& b) {
        if (!box.isInside(b))
            return;
        const std::size_t slot = lattice_.slot(b);
        if (lattice_.numbers()[slot] == freeBlock && !reachedBlock[slot]) {
            reachedBlock[slot] = 1;
            blocks.push_back(b);
        }
    };
    const auto enterVoxel = [&](const openvdb::Coord& v) {
        const openvdb::Coord b = v >> 3;
        const std::int32_t number = lattice_.at(b);
        if (number < 0) {
            enterBlock(b);
            return;
        }
        const int x = v.x() & 7, bit = 8 * (v.y() & 7) + (v.z() & 7);
        const std::uint64_t mask = std::uint64_t(1) << bit;
        if ((open[number][x] & mask) && !(reachable_[number][x] & mask)) {
            reachable_[number][x] |= mask;
            voxels.push_back(v);
        }
    };
    // The box is wider than the shell by a block: its sides are free.
    for (int i = box.min().x(); i <= box.max().x(); ++i)
        for (int j = box.min().y(); j <= box.max().y(); ++j)
            for (int k = box.min().z(); k <= box.max().z(); ++k)
                if (i == box.min().x() || i == box.max().x() || j == box.min().y() || j == box.max().y() ||
                    k == box.min().z() || k == box.max().z())
                    enterBlock({i, j, k});
    while (!blocks.empty() || !voxels.empty()) {
        if (!voxels.empty()) {
            const openvdb::Coord v = voxels.back();
            voxels.pop_back();
            for (int axis = 0; axis < 3; ++axis)
                for (int side = -1; side <= 1; side += 2) {
                    openvdb::Coord next = v;
                    next[axis] += side;
                    enterVoxel(next);
                }
            continue;
        }
        const openvdb::Coord b = blocks.back();
        blocks.pop_back();
        for (int axis = 0; axis < 3; ++axis)
            for (int side = -1; side <= 1; side += 2) {
                openvdb::Coord next = b;
                next[axis] += side;
                if (lattice_.at(next) < 0) {
                    enterBlock(next);
                    continue;
                }
                // The face of the shell block that looks at this one.
                openvdb::Coord v = next << 3;
                v[axis] += side < 0 ? 7 : 0;
                const int u = (axis + 1) % 3, w = (axis + 2) % 3;
                for (int i = 0; i < 8; ++i)
                    for (int j = 0; j < 8; ++j) {
                        openvdb::Coord at = v;
                        at[u] += i;
                        at[w] += j;
                        enterVoxel(at);
                    }
            }
    }
}

} // namespace patina
