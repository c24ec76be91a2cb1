#pragma once
// Meshes of the shapes that have closed forms, turned like those of field_test_shapes.h.

#include "field_test_shapes.h"
#include "surface/mesh.h"

#include <array>
#include <utility>
#include <vector>

namespace patina::test {

/// Flat-shaded faces of object coordinates, up z, as a mesh in the turned lattice.
class FacetedModel {
  public:
    void quad(const Imath::V3d& a, const Imath::V3d& b, const Imath::V3d& c, const Imath::V3d& d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    void triangle(const Imath::V3d& a, const Imath::V3d& b, const Imath::V3d& c) {
        const Imath::V3d normal = (b - a).cross(c - a);
        if (normal.length() < 1e-9)
            return;
        const int first = static_cast<int>(mesh_.positions.size());
        for (const Imath::V3d& p : {a, b, c}) {
            mesh_.positions.emplace_back(toLattice(p));
            mesh_.normals.emplace_back(toLattice(normal).normalized());
        }
        mesh_.triangles.emplace_back(first, first + 1, first + 2);
    }
    SurfaceMesh mesh() const { return mesh_; }

  private:
    SurfaceMesh mesh_;
};

/// A profile in (x, z), anticlockwise seen from -y, drawn out along y; its ends as convex quads of its points.
inline SurfaceMesh prism(const std::vector<Imath::V3d>& profile, const std::vector<std::array<int, 4>>& ends, double length) {
    FacetedModel model;
    const Imath::V3d half(0.0, 0.5 * length, 0.0);
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const Imath::V3d a = profile[i], b = profile[(i + 1) % profile.size()];
        model.quad(a - half, a + half, b + half, b - half);
    }
    for (const auto& [a, b, c, d] : ends) {
        model.quad(profile[a] - half, profile[b] - half, profile[c] - half, profile[d] - half);
        model.quad(profile[d] + half, profile[c] + half, profile[b] + half, profile[a] + half);
    }
    return model.mesh();
}

/// A profile (r, z) turned about the z axis, from the axis below, outside, to the axis above.
inline SurfaceMesh lathe(const std::vector<std::pair<double, double>>& profile, int segments) {
    FacetedModel model;
    const auto at = [&](std::size_t i, int s) {
        const double angle = 2.0 * M_PI * s / segments;
        return Imath::V3d(profile[i].first * std::cos(angle), profile[i].first * std::sin(angle), profile[i].second);
    };
    for (std::size_t i = 0; i + 1 < profile.size(); ++i)
        for (int s = 0; s < segments; ++s)
            model.quad(at(i, s), at(i, s + 1), at(i + 1, s + 1), at(i + 1, s));
    return model.mesh();
}

} // namespace patina::test
