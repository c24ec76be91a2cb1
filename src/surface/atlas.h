#pragma once
// UVs for meshes that have none.

#include "surface/mesh.h"

namespace patina {

/// Gives every face a tile of its own in the unit square (quads a square, triangles half of one, larger polygons a
/// square fitted to their corners), inset so that a map of `resolution` pixels has a gap of texels between tiles: two
/// texels on each side in tiles of 16 texels or more, one down to 4, a quarter of the tile below. No face is mirrored.
/// Two triangles share a tile, with the same gap across its diagonal. Replaces any UVs the mesh has.
void makeFaceAtlas(Mesh& mesh, int resolution);

} // namespace patina
