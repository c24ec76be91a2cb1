// An interface as triangles against a sphere's closed form.

#include "volume/interface_mesh.h"

#include "base/errors.h"
#include "operators/coat.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

TEST(InterfaceMesh, ofACoatedSphereIsTheSphereAroundIt) {
    auto piece = test::makePiece(test::sphere(20.f, 5), test::voxelScale(), 6.0);
    auto work = piece->work();
    coat(work, "cuprite_2", 3.0, nullptr, piece->progress);
    for (const int layer : {0, 1}) {
        const double radius = layer == 0 ? 20.0 : 23.0;
        const SurfaceMesh mesh = interfaceMesh(*piece->volume, layer);
        EXPECT_TRUE(mesh.closed);
        EXPECT_NEAR(mesh.area() / (4 * M_PI * radius * radius), 1.0, 0.01);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            EXPECT_NEAR(mesh.positions[i].length(), radius, 0.1);
            EXPECT_GT(mesh.normals[i] ^ mesh.positions[i].normalized(), 0.999f);
        }
        for (const Imath::V3i& t : mesh.triangles) {
            const Imath::V3f a = mesh.positions[std::size_t(t[0])];
            const Imath::V3f cross =
                (mesh.positions[std::size_t(t[1])] - a).cross(mesh.positions[std::size_t(t[2])] - a);
            EXPECT_GE(cross ^ a, 0.f); // counter-clockwise from outside
        }
    }
    EXPECT_THROW(interfaceMesh(*piece->volume, 2), RunError);
}

TEST(InterfaceMesh, pointsBesideASphereSettleOnIt) {
    auto piece = test::makePiece(test::sphere(20.f, 5), test::voxelScale(), 6.0);
    auto work = piece->work();
    coat(work, "cuprite_2", 3.0, nullptr, piece->progress);
    const SurfaceMesh coarse = interfaceMesh(*piece->volume, 1);
    SurfaceMesh points; // the triangles' middles, up to half a voxel off; then as many that are too far
    for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
        Imath::V3f middle(0.f);
        for (int i = 0; i < 3; ++i)
            middle += coarse.positions[std::size_t(coarse.triangles[t][i])] / 3.f;
        points.positions.push_back(middle * (1.f + (t % 2 ? 0.5f : -0.5f) / 23.f));
    }
    const std::size_t near = points.positions.size();
    for (std::size_t i = 0; i < near; ++i)
        points.positions.push_back(points.positions[i] * (21.f / 23.f));
    for (const Imath::V3f& p : points.positions)
        points.normals.push_back(p.normalized());
    const SurfaceMesh before = points;
    settleOnInterface(*piece->volume, 1, points);
    for (std::size_t i = 0; i < near; ++i) {
        // Between lattice points a sphere of 23 voxels is read up to 0.011 too small.
        EXPECT_NEAR(points.positions[i].length(), 23.0, 0.03);
        EXPECT_EQ(points.positions[near + i], before.positions[near + i]);
    }
}

TEST(InterfaceMesh, ofASheetIsOpenAtNoEdge) {
    auto piece = test::makePiece(test::sheet(40.f, 20), test::voxelScale(), 6.0);
    EXPECT_TRUE(interfaceMesh(*piece->volume, 0).closed);
}

} // namespace
} // namespace patina
