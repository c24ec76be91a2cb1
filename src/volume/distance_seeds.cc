#include "volume/distance_seeds.h"

#include "volume/distance_creases.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

constexpr int padLow = 1, padHigh = 2, padded = 8 + padLow + padHigh; // 11: a cell's corners and what lies around them

using CellMask = std::array<std::uint64_t, 8>;

/// Which set is looked for: where the interpolant is iso.
struct Level {
    float iso, voxelsPerUnit;
    float nowhere; ///< voxels from iso: where the band ends
    float near;    ///< scene units: a block with nothing closer to iso needs no look

    Level(const LevelSetBlocks& levelSet, double voxelSize, double isoUnits)
        : iso(static_cast<float>(isoUnits)), voxelsPerUnit(static_cast<float>(1.0 / voxelSize)),
          nowhere((0.999f * levelSet.background() - std::abs(iso)) * voxelsPerUnit),
          near(static_cast<float>(2.0 * voxelSize)) {}
};

// The trilinear interpolant of eight corners (x slowest) and its gradient.
Imath::V3f trilinear(const float* c, const Imath::V3f& p, float& value) {
    const float c00 = c[0] + p.z * (c[1] - c[0]), c01 = c[2] + p.z * (c[3] - c[2]);
    const float c10 = c[4] + p.z * (c[5] - c[4]), c11 = c[6] + p.z * (c[7] - c[6]);
    const float c0 = c00 + p.y * (c01 - c00), c1 = c10 + p.y * (c11 - c10);
    const float d0 = (c[1] - c[0]) + p.y * ((c[3] - c[2]) - (c[1] - c[0]));
    const float d1 = (c[5] - c[4]) + p.y * ((c[7] - c[6]) - (c[5] - c[4]));
    value = c0 + p.x * (c1 - c0);
    return {c1 - c0, (c01 - c00) + p.x * ((c11 - c10) - (c01 - c00)), d0 + p.x * (d1 - d0)};
}

// A point of the zero set in a cell whose corners differ in sign: the middle of the crossed edges, brought onto the
// trilinear zero set by Newton steps that stay within the cell.
Imath::V3f pointInCell(const float* c) {
    static constexpr int edges[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                                         {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    Imath::V3f sum(0.f);
    int crossed = 0;
    for (const auto& edge : edges) {
        const float a = c[edge[0]], b = c[edge[1]];
        if ((a <= 0.f) == (b <= 0.f))
            continue;
        const float share = a / (a - b);
        const Imath::V3f from(float(edge[0] >> 2), float((edge[0] >> 1) & 1), float(edge[0] & 1)),
            to(float(edge[1] >> 2), float((edge[1] >> 1) & 1), float(edge[1] & 1));
        sum += from + (to - from) * share;
        ++crossed;
    }
    Imath::V3f p = sum / float(crossed);
    for (int step = 0; step < 4; ++step) {
        float value;
        const Imath::V3f gradient = trilinear(c, p, value);
        const float squared = gradient.dot(gradient);
        if (!(squared > 1e-12f))
            break;
        p -= gradient * (value / squared);
        p.x = std::clamp(p.x, 0.f, 1.f);
        p.y = std::clamp(p.y, 0.f, 1.f);
        p.z = std::clamp(p.z, 0.f, 1.f);
    }
    return p;
}

// Brings a point of the trilinear zero set to that of the smooth field whose samples the corners are, and gives normal
// and curvature there. Along axis i the interpolant of a field lies above it by p_i (1 - p_i) / 2 times the second
// derivative, for want of which a sphere of radius R would lose 0.2 / R. That derivative is the harmonic mean of the
// second differences at the line's two ends: of second order where the field is smooth, and that of the smooth side
// next to an edge, so that faces stay flat up to their edges. \param at  the cell's first corner in the padded block
SurfacePatch patchAt(const float* at, const float* c, Imath::V3f& p, float nowhere) {
    constexpr int stride[3] = {padded * padded, padded, 1};
    SurfacePatch patch;
    patch.shape.fill(0.f);
    patch.reach = SurfacePatch::furthestReach;
    float second[3]; // d²/dx_i² at p
    for (int axis = 0; axis < 3; ++axis) {
        const int s = stride[axis], u = (axis + 1) % 3, w = (axis + 2) % 3;
        float line[4];
        for (int n = 0; n < 4; ++n) {
            const float* v = at + (n >> 1) * stride[u] + (n & 1) * stride[w];
            const bool known = std::abs(v[-s]) < nowhere && std::abs(v[2 * s]) < nowhere;
            const float a = v[-s] - 2.f * v[0] + v[s], b = v[0] - 2.f * v[s] + v[2 * s];
            line[n] = known && a * b > 0.f ? 2.f * a * b / (a + b) : 0.f;
        }
        const float low = line[0] + p[w] * (line[1] - line[0]), high = line[2] + p[w] * (line[3] - line[2]);
        second[axis] = low + p[u] * (high - low);
    }
    float value;
    Imath::V3f gradient = trilinear(c, p, value);
    for (int axis = 0; axis < 3; ++axis)
        gradient[axis] += (p[axis] - 0.5f) * second[axis];
    const float slope = gradient.length();
    patch.normal = slope > 0.f ? gradient / slope : Imath::V3f(0.f, 0.f, 1.f);
    if (!(slope > 1e-6f))
        return patch;

    // Mixed second derivatives are those of the interpolant.
    const float alternating = c[7] - c[6] - c[5] + c[4] - c[3] + c[2] + c[1] - c[0];
    const float xy = (c[6] - c[4] - c[2] + c[0]) + p.z * alternating,
                xz = (c[5] - c[4] - c[1] + c[0]) + p.y * alternating,
                yz = (c[3] - c[2] - c[1] + c[0]) + p.x * alternating;
    const float h[3][3] = {{second[0], xy, xz}, {xy, second[1], yz}, {xz, yz, second[2]}};
    const float above =
        0.5f * (p.x * (1.f - p.x) * second[0] + p.y * (1.f - p.y) * second[1] + p.z * (1.f - p.z) * second[2]);
    p += patch.normal * std::clamp(above / slope, -0.2f, 0.2f);

    // S = P H P / |gradient|, P = 1 - n n^T; no sharper than a radius of one voxel.
    const Imath::V3f n = patch.normal;
    const Imath::V3f hn(h[0][0] * n.x + h[0][1] * n.y + h[0][2] * n.z, h[1][0] * n.x + h[1][1] * n.y + h[1][2] * n.z,
                        h[2][0] * n.x + h[2][1] * n.y + h[2][2] * n.z);
    const float nhn = n.dot(hn);
    float s[6], squares = 0.f;
    int at6 = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j, ++at6) {
            s[at6] = (h[i][j] - n[i] * hn[j] - hn[i] * n[j] + nhn * n[i] * n[j]) / slope;
            squares += s[at6] * s[at6] * (i == j ? 1.f : 2.f);
        }
    const float curvature = std::sqrt(squares), scale = curvature > 1.f ? 1.f / curvature : 1.f;
    patch.reach = std::min(SurfacePatch::furthestReach, SurfacePatch::furthestBend / std::max(curvature, 1e-6f));
    for (int i = 0; i < 6; ++i)
        patch.shape[i] = s[i] * scale;
    return patch;
}

// Calls visit(i, j, k, at, corners) for each cell of a block that the surface crosses: `at` is the cell's first corner
// in the padded block, voxels.
template <typename Visit>
void forCrossedCells(const LevelSetBlocks& levelSet, const openvdb::Coord& block, const Level& level,
                     const CellMask* wanted, const Visit& visit) {
    float values[padded * padded * padded];
    levelSet.padded(block, padLow, padHigh, values);
    for (float& v : values)
        v = (v - level.iso) * level.voxelsPerUnit;
    const auto corner = [&](int i, int j, int k) {
        return values + ((i + padLow) * padded + j + padLow) * padded + k + padLow;
    };
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            // Signs of the row's four lines, a bit for each voxel: cells where not all eight corners agree.
            unsigned all = ~0u, any = 0;
            for (int line = 0; line < 4; ++line) {
                const float* v = corner(i + (line >> 1), j + (line & 1), 0);
                unsigned signs = 0;
                for (int k = 0; k < 9; ++k)
                    signs |= unsigned(v[k] <= 0.f) << k;
                all &= signs;
                any |= signs;
            }
            unsigned mixed = (any | any >> 1) & ~(all & all >> 1) & 0xff;
            if (wanted)
                mixed &= static_cast<unsigned>((*wanted)[std::size_t(i)] >> (8 * j)) & 0xff;
            for (int k = 0; k < 8; ++k) {
                if (!(mixed >> k & 1))
                    continue;
                float c[8];
                for (int n = 0; n < 8; ++n)
                    c[n] = *corner(i + (n >> 2), j + ((n >> 1) & 1), k + (n & 1));
                // Where the band ends (the sides of a region) a change of sign is no surface.
                if (std::none_of(c, c + 8, [&](float v) { return std::abs(v) >= level.nowhere; }))
                    visit(i, j, k, corner(i, j, k), c);
            }
        }
}

openvdb::Coord blockOfLeaf(const LevelSetBlocks& levelSet, std::size_t n) {
    return openvdb::Coord(levelSet.leaves()[n]->origin() >> 3);
}

// Whether a block may hold cells that the iso surface crosses.
bool mayCross(const LevelSetBlocks& levelSet, std::size_t n, float iso, float near) {
    const FloatLeaf& leaf = *levelSet.leaves()[n];
    const float* v = leaf.buffer().data();
    int inside = 0, close = 0;
    for (int i = 0; i < 512; ++i) {
        inside += v[i] <= iso;
        close += std::abs(v[i] - iso) < near;
    }
    if (close || (inside > 0 && inside < 512))
        return true;
    // All of one sign and far from the surface; an interface that is no distance may still jump at the block's side.
    float around[9 * 9 * 9];
    levelSet.padded(openvdb::Coord(leaf.origin() >> 3), 0, 1, around);
    int within = 0;
    for (const float value : around)
        within += value <= iso;
    return within > 0 && within < 9 * 9 * 9;
}

// Room for a point in each crossed cell. Cells are counted first, so that nothing is there twice.
PointBlocks roomForPoints(const LevelSetBlocks& levelSet, const Level& level, const std::vector<CellMask>* wanted) {
    const std::size_t leaves = levelSet.leaves().size();
    std::vector<std::uint32_t> count(leaves, 0);
    tbb::parallel_for(std::size_t(0), leaves, [&](std::size_t n) {
        if (mayCross(levelSet, n, level.iso, level.near))
            forCrossedCells(levelSet, blockOfLeaf(levelSet, n), level, wanted ? &(*wanted)[n] : nullptr,
                            [&](int, int, int, const float*, const float*) { ++count[n]; });
    });
    openvdb::CoordBBox box;
    for (std::size_t n = 0; n < leaves; ++n)
        if (count[n] > 0)
            box.expand(blockOfLeaf(levelSet, n));
    PointBlocks points;
    points.lattice = BlockBox(box);
    std::uint32_t total = 0;
    for (std::size_t n = 0; n < leaves; ++n)
        if (count[n] > 0) {
            const openvdb::Coord block = blockOfLeaf(levelSet, n);
            points.lattice.set(block, static_cast<std::int32_t>(points.blocks.size()));
            points.blocks.push_back({block, total, total + count[n]});
            total += count[n];
        }
    points.x.resize(total);
    points.y.resize(total);
    points.z.resize(total);
    return points;
}

} // namespace

SurfaceSeeds makeSurfaceSeeds(const LevelSetBlocks& levelSet, double voxelSize, double iso) {
    const Level level(levelSet, voxelSize, iso);
    SurfaceSeeds seeds;
    PointBlocks& points = seeds.points;
    points = roomForPoints(levelSet, level, nullptr);
    points.blockOf.resize(points.size());
    seeds.patches.resize(points.size());
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t b) {
        std::size_t next = points.blocks[b].begin;
        forCrossedCells(levelSet, points.blocks[b].block, level, nullptr,
                        [&](int i, int j, int k, const float* at, const float* c) {
                            Imath::V3f p = pointInCell(c);
                            seeds.patches[next] = patchAt(at, c, p, level.nowhere);
                            points.x[next] = float(i) + p.x;
                            points.y[next] = float(j) + p.y;
                            points.z[next] = float(k) + p.z;
                            points.blockOf[next++] = static_cast<std::uint32_t>(b);
                        });
    });
    if (iso == 0.0) // parallel surfaces of sharp edges are round
        sharpenCreases(seeds);
    return seeds;
}

PointBlocks makeSurfacePoints(const LevelSetBlocks& levelSet, double voxelSize, const std::vector<CellMask>* wanted) {
    const Level level(levelSet, voxelSize, 0.0);
    PointBlocks points = roomForPoints(levelSet, level, wanted);
    tbb::parallel_for(std::size_t(0), points.blocks.size(), [&](std::size_t b) {
        const PointBlocks::Block& block = points.blocks[b];
        const std::int32_t leaf = levelSet.lattice().at(block.block.x(), block.block.y(), block.block.z());
        std::size_t next = block.begin;
        forCrossedCells(levelSet, block.block, level, wanted ? &(*wanted)[std::size_t(leaf)] : nullptr,
                        [&](int i, int j, int k, const float*, const float* c) {
                            constexpr float end = 0.9999f;
                            const Imath::V3f p = pointInCell(c);
                            points.x[next] = float(i) + std::min(p.x, end);
                            points.y[next] = float(j) + std::min(p.y, end);
                            points.z[next++] = float(k) + std::min(p.z, end);
                        });
    });
    return points;
}

} // namespace patina
