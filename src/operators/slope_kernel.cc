#include "operators/slope_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace patina {

namespace {

// Each loop below is written once and built for several sets of instructions, so it must become part of its caller.
// Without fused products (-ffp-contract=off) every set rounds the same.
#define PATINA_INLINE inline __attribute__((always_inline))

PATINA_INLINE void findFeetIn(const FeetInput& input, LeafFeet& feet) {
    unsigned count = 0;
    std::int32_t before = 0; // active voxels before this word
    for (unsigned w = 0; w < 8; ++w) {
        const std::uint64_t active = input.active[w];
        for (std::uint64_t word = input.wanted[w]; word; word &= word - 1) {
            const std::uint64_t lower = (word & (~word + 1)) - 1; // the bits below the lowest one
            const std::int32_t point = before + __builtin_popcountll(active & lower);
            feet.voxel[count] = static_cast<std::uint16_t>(64 * w + unsigned(__builtin_ctzll(word)));
            feet.point[count] = point;
            count += input.points[point].triangle >= 0;
        }
        before += __builtin_popcountll(active);
    }
    feet.count = count;
    const float inverse = input.inverseVoxelSize;
    const SurfacePoint* const points = input.points;
    const Imath::V3i* const triangles = input.triangles;
    const Imath::V3f* const positions = input.positions;
    const std::int32_t* const point = feet.point;
    float *const x = feet.x, *const y = feet.y, *const z = feet.z;
#pragma GCC ivdep
    for (unsigned i = 0; i < count; ++i) {
        const std::int32_t p = point[i], t = points[p].triangle;
        const float u = points[p].u, v = points[p].v;
        const std::int32_t a = triangles[t].x, b = triangles[t].y, c = triangles[t].z;
        const float ax = positions[a].x, ay = positions[a].y, az = positions[a].z;
        x[i] = (ax + (positions[b].x - ax) * u + (positions[c].x - ax) * v) * inverse;
        y[i] = (ay + (positions[b].y - ay) * u + (positions[c].y - ay) * v) * inverse;
        z[i] = (az + (positions[b].z - az) * u + (positions[c].z - az) * v) * inverse;
    }
}

// The values in a box, from one leaf below this one on, row after row.
struct Box {
    std::int32_t low[3], size[3];
};

PATINA_INLINE void copyBox(const SlopeInput& input, const Box& box, float* values) {
    for (std::int32_t i = box.low[0]; i < box.low[0] + box.size[0]; ++i)
        for (std::int32_t j = box.low[1]; j < box.low[1] + box.size[1]; ++j) {
            const float* const* leaves = &input.around[(i >> 3) * 9 + (j >> 3) * 3];
            const std::int32_t row = (i & 7) << 6 | (j & 7) << 3;
            for (std::int32_t k = box.low[2], end = k + box.size[2]; k < end;) {
                const std::int32_t until = std::min(end, (k | 7) + 1);
                const float* from = leaves[k >> 3] + row + (k & 7);
                for (; k < until; ++k)
                    *values++ = *from++;
            }
        }
}

PATINA_INLINE void readSlopesIn(const SlopeInput& input, LeafFeet& feet) {
    const unsigned count = feet.count;
    constexpr std::int32_t last = 22; // the last cell whose corners are all among the 24³ values
    alignas(64) std::int32_t cell[3][LeafFeet::most];
    const float* const at[3] = {feet.x, feet.y, feet.z};
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t from = input.origin[axis] - 8;
        const float* const p = at[axis];
        std::int32_t* const c = cell[axis];
        std::int32_t low = last, high = 0;
#pragma GCC ivdep
        for (unsigned i = 0; i < count; ++i) {
            const auto whole = static_cast<std::int32_t>(p[i]);
            const std::int32_t floor = whole - std::int32_t(p[i] < static_cast<float>(whole)) - from;
            const std::int32_t within = std::min(std::max(floor, 0), last);
            low = std::min(low, within);
            high = std::max(high, within);
            c[i] = floor;
        }
        box.low[axis] = low;
        box.size[axis] = std::max(high - low, 0) + 2;
    }
    alignas(64) float values[24 * 24 * 24];
    copyBox(input, box, values);

    const std::int32_t strideX = box.size[1] * box.size[2], strideY = box.size[2];
    const float *const v000 = values, *const v001 = values + 1, *const v010 = values + strideY, *const v011 = v010 + 1,
                       *const v100 = values + strideX, *const v101 = v100 + 1, *const v110 = v100 + strideY,
                       *const v111 = v110 + 1;
    const std::int32_t fromX = input.origin[0] - 8, fromY = input.origin[1] - 8, fromZ = input.origin[2] - 8;
    const float inverseVoxelSize = input.inverseVoxelSize;
    const std::int32_t *const cx = cell[0], *const cy = cell[1], *const cz = cell[2];
    const float *const px = feet.x, *const py = feet.y, *const pz = feet.z;
    float* const slopes = feet.slope;
#pragma GCC ivdep
    for (unsigned i = 0; i < count; ++i) {
        const std::int32_t ix = std::min(std::max(cx[i], 0), last), iy = std::min(std::max(cy[i], 0), last),
                           iz = std::min(std::max(cz[i], 0), last);
        const std::int32_t n = (ix - box.low[0]) * strideX + (iy - box.low[1]) * strideY + (iz - box.low[2]);
        const float x = px[i] - static_cast<float>(cx[i] + fromX), y = py[i] - static_cast<float>(cy[i] + fromY),
                    z = pz[i] - static_cast<float>(cz[i] + fromZ);
        const float c0 = v000[n], c2 = v010[n], c4 = v100[n], c6 = v110[n];
        const float z00 = v001[n] - c0, z01 = v011[n] - c2, z10 = v101[n] - c4, z11 = v111[n] - c6;
        const float c00 = c0 + z * z00, c01 = c2 + z * z01, c10 = c4 + z * z10, c11 = c6 + z * z11;
        const float gx = (c10 + y * (c11 - c10)) - (c00 + y * (c01 - c00));
        const float gy = (c01 - c00) + x * ((c11 - c10) - (c01 - c00));
        const float dz0 = z00 + y * (z01 - z00), dz1 = z10 + y * (z11 - z10);
        const float gz = dz0 + x * (dz1 - dz0);
        const float slope = std::sqrt(gx * gx + gy * gy + gz * gz) * inverseVoxelSize;
        // Not a number where there is no leaf.
        const bool there = (slope >= 0.f) & (ix == cx[i]) & (iy == cy[i]) & (iz == cz[i]);
        slopes[i] = there ? slope : -1.f;
    }
}

#if defined(__x86_64__)
__attribute__((target("avx2,popcnt"))) void findFeetWide(const FeetInput& input, LeafFeet& feet) {
    findFeetIn(input, feet);
}
__attribute__((target("avx2"))) void readSlopesWide(const SlopeInput& input, LeafFeet& feet) {
    readSlopesIn(input, feet);
}
#endif
void findFeetPlain(const FeetInput& input, LeafFeet& feet) {
    findFeetIn(input, feet);
}
void readSlopesPlain(const SlopeInput& input, LeafFeet& feet) {
    readSlopesIn(input, feet);
}

} // namespace

SlopeKernel slopeKernel(bool wide) {
#if defined(__x86_64__)
    if (wide && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt"))
        return {findFeetWide, readSlopesWide};
#else
    (void)wide;
#endif
    return {findFeetPlain, readSlopesPlain};
}

} // namespace patina
