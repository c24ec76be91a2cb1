// Scans without UVs get charts that maps can be baked into.

#include "export/texel_map.h"
#include "surface/limit_surface.h"
#include "surface/region_charts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina {
namespace {

// A ramp that winds twice around the y axis: all of it faces up, one turn above the other.
Mesh spiralRamp() {
    Mesh mesh;
    mesh.name = "ramp";
    constexpr int steps = 200, across = 3;
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= across; ++j) {
            const double angle = 4.0 * M_PI * i / steps, radius = 1.0 + double(j) / across;
            mesh.positions.emplace_back(float(radius * std::cos(angle)), float(0.1 * angle),
                                        float(-radius * std::sin(angle)));
        }
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < across; ++j) {
            const int a = i * (across + 1) + j, b = a + 1, c = a + across + 1, d = c + 1;
            for (const int corner : {a, b, d, a, d, c})
                mesh.faceVertices.push_back(corner);
            mesh.faceSizes.insert(mesh.faceSizes.end(), {3, 3});
        }
    return mesh;
}

TEST(ScanCharts, WhatLiesOnItselfIsTakenApart) {
    Mesh mesh = spiralRamp();
    makeProjectedCharts(mesh, {0, 1, 0}, 512);
    ASSERT_EQ(mesh.faceUvs.size(), mesh.faceVertices.size());
    LimitSurfaceOptions options;
    options.scheme = SubdivisionScheme::none;
    const SurfaceMesh surface = makeLimitSurface(mesh, options);
    const TexelMap texels = makeTexelMap(surface, 512, 16); // throws where charts overlap
    EXPECT_EQ(texels.overlapping, 0u);
    // Two rings of radius 1 and 2 beside each other would fill 0.29 of a square.
    EXPECT_GT(static_cast<double>(texels.covered), 0.15 * 512 * 512);
    for (const Imath::V2f& uv : mesh.uvs)
        for (int i = 0; i < 2; ++i) {
            EXPECT_GT(uv[i], 0.f);
            EXPECT_LT(uv[i], 1.f);
        }
}

} // namespace
} // namespace patina
