#pragma once
// Surfaces and materials whose pictures are known in closed form.

#include "optics/patina_bsdf.h"
#include "render/scene.h"
#include "surface/mesh.h"

#include <cmath>

namespace patina {

/// A closed sphere of 2 n² quads, normals exactly radial.
inline SurfaceMesh sphereMesh(int n, float radius, const Imath::V3f& centre = Imath::V3f(0.f)) {
    SurfaceMesh mesh;
    mesh.positions = {centre + Imath::V3f(0, 0, radius), centre - Imath::V3f(0, 0, radius)};
    mesh.normals = {{0, 0, 1}, {0, 0, -1}};
    for (int i = 1; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const double t = M_PI * i / n, p = M_PI * j / n;
            const Imath::V3f d(float(std::sin(t) * std::cos(p)), float(std::sin(t) * std::sin(p)), float(std::cos(t)));
            mesh.positions.push_back(centre + d * radius);
            mesh.normals.push_back(d.normalized());
        }
    const auto vertex = [n](int i, int j) { return i == 0 ? 0 : i == n ? 1 : 2 + (i - 1) * 2 * n + j % (2 * n); };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            if (i + 1 < n)
                mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            if (i > 0)
                mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    return mesh;
}

/// An open square of side 2 in the plane z = 0, facing +z.
inline SurfaceMesh squareMesh() {
    SurfaceMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.closed = false;
    return mesh;
}

inline PatinaBsdf lambert(const Imath::V3f& albedo) {
    Appearance look;
    look.diffuse = albedo;
    return PatinaBsdf(look);
}

/// Polished copper: one conductor's lobe.
inline PatinaBsdf copper(float alpha = 0.2f) {
    Appearance look;
    look.lobes.resize(1);
    look.lobes[0].colour = {0.93f, 0.62f, 0.52f};
    look.lobes[0].edgeColour = Imath::V3f(1.f);
    look.lobes[0].alpha = alpha;
    return PatinaBsdf(look);
}

/// A surface of one material, alone.
inline RenderScene sceneOf(const SurfaceMesh& surface, const PatinaBsdf& bsdf) {
    RenderScene scene;
    scene.surface = &surface;
    scene.material = [bsdf](const SurfacePoint&, const Imath::V3f&) { return bsdf; };
    scene.ground = false;
    scene.background = Imath::V3f(-1.f); // marks pixels that the object does not cover
    return scene;
}

} // namespace patina
