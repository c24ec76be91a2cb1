#pragma once
// The frames in which vector displacement is written for programs that want it relative to the surface.

#include "surface/mesh.h"

#include <Imath/ImathVec.h>

#include <string>
#include <vector>

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

/// Tangents as MikkTSpace makes them, which Blender and others bake and render with: at each vertex the direction of u
/// on the surface, averaged over its triangles of one chart by their angles (mirrored charts apart), at right angles to
/// the vertex's normal; interpolated between the vertices. Triangles without an area in UV space do not count; where
/// only such meet, any direction stands in. Safe from any thread.
class VectorFrames {
  public:
    /// \param surface  with UVs; kept by reference
    explicit VectorFrames(const SurfaceMesh& surface);

    /// Unit vectors; the tangent need not be quite at right angles to the normal between vertices, and the bitangent is
    /// their cross product, on the side to which v runs.
    struct Frame {
        Imath::V3d tangent, bitangent, normal;
    };
    Frame at(const SurfacePoint& point) const;

  private:
    const SurfaceMesh& surface_;
    std::vector<Imath::V3f> tangents_;
    std::vector<Imath::V3i> corners_; ///< of each triangle, into tangents_
    std::vector<char> mirrored_;      ///< per triangle: v runs against the cross product of normal and u
};

/// The channels of an object-space vector. \pre the frame's vectors are no plane
Imath::V3d toSpace(VectorSpace space, const VectorFrames::Frame& frame, const Imath::V3d& vector);
/// What a renderer makes of them.
Imath::V3d fromSpace(VectorSpace space, const VectorFrames::Frame& frame, const Imath::V3d& channels);

} // namespace patina
