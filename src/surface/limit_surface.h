#pragma once
// Cages become their limit surface (OpenSubdiv) before anything else sees them.

#include "surface/mesh.h"

namespace patina {

enum class SubdivisionScheme {
    automatic, ///< catmullClark where any face has four or more corners, none for triangle meshes
    none,
    catmullClark,
    loop,
};

struct LimitSurfaceOptions {
    SubdivisionScheme scheme = SubdivisionScheme::automatic;
    /// Subdivisions, 0…7; -1: 1…7, so many that 95 of 100 edges are no longer than targetEdge and the triangles no more
    /// than four million.
    int level = -1;
    double targetEdge = 0.0; ///< scene units; used where level is -1; 0: 1/256 of the longest side
};

/// Vertices lie on the limit surface with limit normals (cross product of the limit tangents); boundaries and corners
/// are kept (edge and corner rule), creases and sharp corners too. UVs: linear along the borders of charts, which
/// therefore stay where they are, smooth inside them (Blender's default, "boundaries" in USD). Per-vertex attributes
/// are interpolated linearly and keep their range. `none` cuts polygons into triangles and gives angle-weighted
/// normals. Quads are cut along the shorter diagonal. `closed`: every edge of the control mesh has two faces; without a
/// scheme, vertices at one place count as one. With `automatic`, a mesh that cannot be subdivided is used as it is, and
/// `note` says so. \throws ModelError where the topology cannot be subdivided by the scheme asked for; Loop on
/// polygons; a level above 7;
///         no faces.
SurfaceMesh makeLimitSurface(const Mesh& mesh, const LimitSurfaceOptions& options);

} // namespace patina
