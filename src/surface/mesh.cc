#include "surface/mesh.h"

namespace patina {

using Imath::Box3f;
using Imath::V2d;
using Imath::V3d;
using Imath::V3f;
using Imath::V3i;

namespace {

Box3f boundsOf(const std::vector<V3f>& positions) {
    Box3f box;
    for (const V3f& position : positions)
        box.extendBy(position);
    return box;
}

} // namespace

Box3f Mesh::bounds() const {
    return boundsOf(positions);
}

Box3f SurfaceMesh::bounds() const {
    return boundsOf(positions);
}

double SurfaceMesh::area() const {
    double twice = 0.0;
    for (const V3i& triangle : triangles) {
        const V3d a(positions[triangle.x]);
        twice += (V3d(positions[triangle.y]) - a).cross(V3d(positions[triangle.z]) - a).length();
    }
    return 0.5 * twice;
}

V3d positionAt(const SurfaceMesh& surface, const SurfacePoint& point) {
    const V3i& triangle = surface.triangles[point.triangle];
    const double u = point.u, v = point.v;
    return (1.0 - u - v) * V3d(surface.positions[triangle.x]) + u * V3d(surface.positions[triangle.y]) +
           v * V3d(surface.positions[triangle.z]);
}

V3d normalAt(const SurfaceMesh& surface, const SurfacePoint& point) {
    const V3i& triangle = surface.triangles[point.triangle];
    const double u = point.u, v = point.v;
    const V3d normal = (1.0 - u - v) * V3d(surface.normals[triangle.x]) + u * V3d(surface.normals[triangle.y]) +
                       v * V3d(surface.normals[triangle.z]);
    const double length = normal.length();
    // Opposite normals can cancel on a folded triangle: the nearest corner's normal then stands for the point.
    if (length > 1e-6)
        return normal / length;
    const int corner = u >= v && u >= 1.0 - u - v ? triangle.y : (v >= 1.0 - u - v ? triangle.z : triangle.x);
    return V3d(surface.normals[corner]);
}

V2d uvAt(const SurfaceMesh& surface, const SurfacePoint& point) {
    const V3i& triangle = surface.triangleUvs[point.triangle];
    const double u = point.u, v = point.v;
    return (1.0 - u - v) * V2d(surface.uvs[triangle.x]) + u * V2d(surface.uvs[triangle.y]) +
           v * V2d(surface.uvs[triangle.z]);
}

} // namespace patina
