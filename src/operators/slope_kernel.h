#pragma once
// The inner loops of an even shift: the feet of a leaf's voxels, and a level set's slopes there. Knows no grids.

#include "surface/mesh.h"

#include <Imath/ImathVec.h>

#include <cstdint>

namespace patina {

/// Some voxels of a leaf of 8³ and their feet, a column for each quantity.
struct LeafFeet {
    static constexpr unsigned most = 512;
    unsigned count = 0;
    std::uint16_t voxel[most]; ///< position in the leaf
    std::int32_t point[most];  ///< number among the leaf's surface points
    alignas(64) float x[most];
    alignas(64) float y[most]; ///< of the foot, in voxels
    alignas(64) float z[most];
    alignas(
        64) float slope[most]; ///< below 0 where the foot lies farther than a leaf away, or where there are no values
};

/// What feet are made of.
struct FeetInput {
    const std::uint64_t* active; ///< 8 words, bit 8 y + z of word x
    const std::uint64_t* wanted; ///< among the active ones
    const SurfacePoint* points;  ///< of the active voxels in order
    const Imath::V3i* triangles;
    const Imath::V3f* positions; ///< scene units
    float inverseVoxelSize;
};

/// What slopes are read from.
struct SlopeInput {
    const float* around[27]; ///< the values of the leaf (number 13) and its neighbours, z fastest
    std::int32_t origin[3];  ///< of the leaf, voxels
    float inverseVoxelSize;  ///< makes slopes of scene units per voxel those per scene unit
};

/// One build of the loops: all give the same bits.
struct SlopeKernel {
    /// The feet of the voxels wanted, except those that have none (triangle -1).
    void (*findFeet)(const FeetInput& input, LeafFeet& feet);
    /// |grad phi| there, trilinear as NestSampler has it, in single precision (slopes to a millionth, which is a
    /// millionth of the thickness moved).
    void (*readSlopes)(const SlopeInput& input, LeafFeet& feet);
};

/// For this processor (`wide`: vector instructions that gather, where it has them).
SlopeKernel slopeKernel(bool wide = true);

} // namespace patina
