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

TEST(InterfaceMesh, ofASheetIsOpenAtNoEdge) {
    auto piece = test::makePiece(test::sheet(40.f, 20), test::voxelScale(), 6.0);
    EXPECT_TRUE(interfaceMesh(*piece->volume, 0).closed);
}

} // namespace
} // namespace patina
