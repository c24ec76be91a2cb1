#pragma once
// An open sheet has no inside: it is given a back and a rim, so that there is metal to voxelise.

#include "surface/mesh.h"

namespace patina {

/// A surface whose first `frontTriangles` triangles are the model's own; the rest is what closes it.
struct ClosedSurface {
    std::vector<Imath::V3f> positions;
    std::vector<Imath::V3i> triangles;
    std::size_t frontTriangles = 0;
};

/// A closed surface as it is; an open one moved by `thickness` (scene units) against its vertex normals, turned round
/// and joined along the open edges. Layers grow on the front only (see SurfaceBinding).
ClosedSurface closeSurface(const SurfaceMesh& surface, double thickness);

} // namespace patina
