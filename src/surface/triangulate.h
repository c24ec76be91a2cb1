#pragma once
// Polygons become triangles.

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// Sum of the cross products of a polygon's consecutive corners: twice its area vector (Newell's method), also for
/// polygons that are not planar.
Imath::V3d polygonAreaVector(const std::vector<Imath::V3f>& positions, const int* corners, int count);

/// Cuts one polygon into count - 2 triangles of local corner numbers (0 … count - 1), in the polygon's winding: quads
/// along the shorter diagonal that lies inside, larger ones by clipping ears (concave planar polygons come out right).
/// Ties go to the smaller corner, so the cut is always the same.
void triangulatePolygon(const std::vector<Imath::V3f>& positions, const int* corners, int count,
                        std::vector<Imath::V3i>& triangles);

} // namespace patina
