#pragma once
// The frames in which vector displacement is written for programs that want it relative to the surface.

#include "surface/uv_frame.h"

#include <Imath/ImathVec.h>

#include <string>

namespace patina {

/// What the channels R, G, B of vector_displacement are; lengths are scene units in each.
enum class VectorSpace {
    object,    ///< x, y, z of the model: the same in every program
    blender,   ///< tangent, normal, bitangent (Blender's Vector Displacement node)
    materialx, ///< tangent, bitangent, normal (MaterialX and Karma: dPdu, dPdv, N, of unit length)
};

/// "object", "blender", "materialx": the attribute patina_space of the map.
const char* nameOf(VectorSpace space);
/// \throws RunError where it is none of these
VectorSpace vectorSpaceNamed(const std::string& name);

/// The channels of an object-space vector. \param frame  TangentFrames::interpolatedAt(), as renderers have it. \pre the frame's vectors are no plane
Imath::V3d toSpace(VectorSpace space, const TangentFrames::Frame& frame, const Imath::V3d& vector);
/// What a renderer makes of them.
Imath::V3d fromSpace(VectorSpace space, const TangentFrames::Frame& frame, const Imath::V3d& channels);

} // namespace patina
