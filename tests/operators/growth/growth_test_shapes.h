#pragma once
// Meshes for the tests of growth.

#include "operators/growth/growth_lattice.h"
#include "surface/mesh.h"

#include <cmath>
#include <map>
#include <tuple>

namespace patina::test {

inline double meshArea(const SurfaceMesh& mesh) {
    double area = 0.0;
    for (const Imath::V3i& t : mesh.triangles)
        area += 0.5 * ((Imath::V3d(mesh.positions[t.y]) - Imath::V3d(mesh.positions[t.x])) %
                       (Imath::V3d(mesh.positions[t.z]) - Imath::V3d(mesh.positions[t.x])))
                          .length();
    return area;
}

inline double latticeArea(const GrowthLattice& lattice) {
    double area = 0.0;
    for (const float a : lattice.areas)
        area += a;
    return area * lattice.cell * lattice.cell;
}

/// A square of a given side facing `normal`, centred a little off the origin.
inline SurfaceMesh square(Imath::V3d normal, double side) {
    normal.normalize();
    const Imath::V3d other = std::abs(normal.x) < 0.9 ? Imath::V3d(1, 0, 0) : Imath::V3d(0, 1, 0);
    const Imath::V3d u = (other % normal).normalized() * (0.5 * side), v = normal % u;
    const Imath::V3d centre(0.137, -0.211, 0.318);
    SurfaceMesh mesh;
    for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
        mesh.positions.emplace_back(Imath::V3f(centre + u * a + v * b));
    mesh.normals.assign(4, Imath::V3f(normal));
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.closed = false;
    return mesh;
}

/// A sphere about the origin: six n x n grids of a cube, blown up, joined at their edges.
inline SurfaceMesh sphere(double radius, int n) {
    SurfaceMesh mesh;
    std::map<std::tuple<int, int, int>, int> known;
    const auto vertex = [&](Imath::V3i p) {
        const auto [place, isNew] = known.emplace(std::make_tuple(p.x, p.y, p.z), int(mesh.positions.size()));
        if (isNew) {
            Imath::V3d d;
            for (int i = 0; i < 3; ++i)
                d[i] = std::tan(double(p[i]) / n * std::acos(-1.0) / 4.0);
            d.normalize();
            mesh.positions.emplace_back(Imath::V3f(d * radius));
            mesh.normals.emplace_back(Imath::V3f(d));
        }
        return place->second;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (int side = -1; side <= 1; side += 2)
            for (int i = -n; i < n; i += 2)
                for (int j = -n; j < n; j += 2) {
                    const auto at = [&](int a, int b) {
                        Imath::V3i p;
                        p[axis] = side * n;
                        p[(axis + 1) % 3] = a;
                        p[(axis + 2) % 3] = b;
                        return vertex(p);
                    };
                    int c[4] = {at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)};
                    if (side < 0)
                        std::swap(c[1], c[3]);
                    mesh.triangles.emplace_back(c[0], c[1], c[2]);
                    mesh.triangles.emplace_back(c[0], c[2], c[3]);
                }
    return mesh;
}

} // namespace patina::test
