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
    int level = -1;           ///< subdivisions; -1: until edges are about targetEdge, at most 7
    double targetEdge = 0.0;  ///< scene units; used where level is -1
};

/// Vertices lie on the limit surface with limit normals; boundaries and corners are kept (edge and corner rule), UVs
/// keep their corners and seams. Per-vertex attributes are carried along.
/// \throws ModelError where the topology cannot be subdivided.
SurfaceMesh makeLimitSurface(const Mesh& mesh, const LimitSurfaceOptions& options);

} // namespace patina
