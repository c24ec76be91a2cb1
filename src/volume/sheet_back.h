#pragma once
// An open sheet has no inside: it is given a back and a rim, so that there is metal to voxelise.

#include "surface/mesh.h"

namespace patina {

/// A surface whose first `frontTriangles` triangles are the model's own; the rest is what closes it: the back, and from
/// `firstRimTriangle` on the rim, two triangles for each open side.
struct ClosedSurface {
    /// An open side of the model: a face and two of its corners (0 to 2).
    struct OpenSide {
        int triangle;
        int from, to;
    };
    std::vector<Imath::V3f> positions;
    std::vector<Imath::V3i> triangles;
    std::size_t frontTriangles = 0;
    std::size_t firstRimTriangle = 0;
    std::vector<OpenSide> openSides;
};

/// Adds what a surface lacks to be closed. Shells that are closed stay as they are; each open one (see MeshTopology) is
/// moved by up to `thickness` (scene units) against its vertex normals, turned round and joined along the open edges:
/// half way, where another part of the surface lies behind it, but not less than a fifth of the thickness. Layers grow
/// on the front and over its edge, not on the back (see SurfaceBinding).
ClosedSurface closeSurface(const SurfaceMesh& surface, double thickness);

} // namespace patina
