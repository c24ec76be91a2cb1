#pragma once
// The displaced surface itself as a mesh, for programs that displace nothing.

#include "base/progress.h"
#include "optics/layer_stack.h"
#include "surface/mesh.h"
#include "volume/layer_volume.h"

namespace patina {

/// The diced surface, each vertex moved along its normal by the height of the stack there; normals are the moved
/// surface's, angle-weighted; triangles and UVs stay. Attributes per vertex: `thickness_01_tarnish_1`, … (real µm),
/// `material_id` (the outermost material: as in the volume's palette), and `red`, `green`, `blue`: the flattened base
/// colour, encoded as sRGB, as colours of vertices are read. Overhangs are drawn as walls, as by a height map. As fine
/// as the surface is diced: about 1.5 voxels, or --subdivide.
/// \param surface  in the volume's coordinates
/// \param optics   of [metal, layer 1, … layer n] of the volume, in this order
/// \param keepExaggeration  heights as drawn in the volume instead of real
SurfaceMesh makeMicroMesh(const LayerVolume& volume, const SurfaceMesh& surface, const StackOptics& optics,
                          bool keepExaggeration, Progress& progress);

} // namespace patina
