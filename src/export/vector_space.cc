#include "export/vector_space.h"

#include "base/errors.h"

namespace patina {

using Imath::V3d;

const char* nameOf(VectorSpace space) {
    return space == VectorSpace::object ? "object" : space == VectorSpace::blender ? "blender" : "materialx";
}

VectorSpace vectorSpaceNamed(const std::string& name) {
    for (const VectorSpace space : {VectorSpace::object, VectorSpace::blender, VectorSpace::materialx})
        if (name == nameOf(space))
            return space;
    throw RunError(name, "is no space of vector displacement", "these are object, blender and materialx");
}

V3d toSpace(VectorSpace space, const TangentFrames::Frame& frame, const V3d& vector) {
    if (space == VectorSpace::object)
        return vector;
    // The bitangent is at right angles to both others; these need not be to each other.
    const double slant = frame.tangent.dot(frame.normal);
    const double along = (vector.dot(frame.tangent) - slant * vector.dot(frame.normal)) / (1.0 - slant * slant);
    const double up = vector.dot(frame.normal) - slant * along;
    const double across = vector.dot(frame.bitangent);
    return space == VectorSpace::blender ? V3d(along, up, across) : V3d(along, across, up);
}

V3d fromSpace(VectorSpace space, const TangentFrames::Frame& frame, const V3d& channels) {
    if (space == VectorSpace::object)
        return channels;
    const double up = space == VectorSpace::blender ? channels.y : channels.z;
    const double across = space == VectorSpace::blender ? channels.z : channels.y;
    return frame.tangent * channels.x + frame.normal * up + frame.bitangent * across;
}

} // namespace patina
