#pragma once
// A field read side by side at the creases between flat faces, where a cell of the lattice holds values of both.

#include "operators/fields/open_places.h"
#include "operators/maps/thickness_map.h"

namespace patina {

/// Within two voxels of a crease or an edge between flat faces that differ by more than 45° the field is the value at
/// the point of a plane through those of the surface voxels that face as the point does (MapPoint::normal); everywhere
/// else, and where none faces so, it is the map's own. Keeps the voxels of creases alone; a model without wide
/// triangles gets the map back. \param field  of makeFieldMap(), stored for `surface`
ThicknessMapPtr readBySides(ThicknessMapPtr field, const SurfaceVoxels& surface, const OpenPlaces& places,
                            double voxelSize);

} // namespace patina
