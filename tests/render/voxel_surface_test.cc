// The voxels' own surface where two sides of a gap lie within a voxel of each other.

#include "render/voxel_surface.h"

#include "support/test_surfaces.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace patina {
namespace {

using Imath::V3f;

constexpr float gap = 0.7f; // voxels

// Along no axis of the lattice: the gap passes lattice points at all distances, is open here and closed
// there.
const V3f up = V3f(0.31f, 0.42f, 0.87f).normalized(), across = up.cross(V3f(0.f, 1.f, 0.f)).normalized(),
          along = up.cross(across);

void addSlab(SurfaceMesh& mesh, float bottom, float top) {
    constexpr float half = 9.f;
    constexpr int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : faces) {
        const int first = int(mesh.positions.size());
        V3f corners[4];
        for (int i = 0; i < 4; ++i)
            corners[i] = across * (face[i] & 1 ? half : -half) + along * (face[i] & 2 ? half : -half) +
                         up * (face[i] & 4 ? top : bottom);
        const V3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
        for (const V3f& corner : corners) {
            mesh.positions.push_back(corner);
            mesh.normals.push_back(normal);
        }
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
}

// Each triangle into 4, with flat middles.
SurfaceMesh split(const SurfaceMesh& coarse) {
    SurfaceMesh fine = coarse;
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
        const auto [found, isNew] = middles.try_emplace(std::minmax(a, b), int(fine.positions.size()));
        if (isNew) {
            fine.positions.push_back((coarse.positions[std::size_t(a)] + coarse.positions[std::size_t(b)]) * 0.5f);
            fine.normals.push_back((coarse.normals[std::size_t(a)] + coarse.normals[std::size_t(b)]).normalized());
        }
        return found->second;
    };
    fine.triangles.clear();
    for (const Imath::V3i& t : coarse.triangles) {
        const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
        fine.triangles.insert(fine.triangles.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
    }
    return fine;
}

V3f areaVector(const SurfaceMesh& mesh, const Imath::V3i& t) {
    const V3f a = mesh.positions[std::size_t(t[0])];
    return (mesh.positions[std::size_t(t[1])] - a).cross(mesh.positions[std::size_t(t[2])] - a);
}

struct VoxelSurfaceOfAGap : ::testing::Test {
    std::unique_ptr<test::Piece> piece;
    SurfaceMesh flat; // as split, before it settled
    VoxelSurface surface;

    void SetUp() override {
        SurfaceMesh slabs;
        addSlab(slabs, -4.f, -0.5f * gap);
        addSlab(slabs, 0.5f * gap, 4.f);
        for (std::size_t t = 0; t < slabs.triangles.size(); ++t)
            slabs.triangleFaces.push_back(int(t / 2));
        piece = test::makePiece(std::move(slabs), test::voxelScale());
        surface = voxelSurface(*piece->volume, piece->surface,
                               [&](const SurfaceMesh& coarse) { return flat = split(split(split(coarse))); });
    }

    // A vertex in the gap, well within its rim.
    bool isInGap(std::size_t v) const {
        const V3f& p = surface.shown.positions[v];
        return std::abs(p ^ up) < 1.f && std::abs(p ^ across) < 6.f && std::abs(p ^ along) < 6.f;
    }
};

TEST_F(VoxelSurfaceOfAGap, NoTriangleTurnsOver) {
    const SurfaceMesh& shown = surface.shown;
    std::size_t inGap = 0, turned = 0;
    for (const Imath::V3i& t : shown.triangles) {
        inGap += isInGap(std::size_t(t[0]));
        turned += (areaVector(shown, t) ^ areaVector(flat, t)) < 0.f;
    }
    EXPECT_GT(inGap, 10000u);
    EXPECT_EQ(turned, 0u);
}

TEST_F(VoxelSurfaceOfAGap, NormalsFaceOutOfTheirTriangles) {
    const SurfaceMesh& shown = surface.shown;
    std::size_t corners = 0, inward = 0;
    for (const Imath::V3i& t : shown.triangles) {
        const V3f out = areaVector(shown, t);
        for (int i = 0; i < 3; ++i, ++corners)
            inward += (out ^ shown.normals[std::size_t(t[i])]) < -0.1f * out.length();
    }
    // At the rims of necks across the gap and of the slabs; measured: 5e-4.
    EXPECT_LT(double(inward) / double(corners), 1e-3);
}

TEST_F(VoxelSurfaceOfAGap, EachSideReadsItsOwnHalfOfTheModel) {
    std::size_t sides[2] = {}, wrong = 0;
    for (std::size_t v = 0; v < surface.shown.positions.size(); ++v) {
        const float facing = surface.shown.normals[v] ^ up;
        if (!isInGap(v) || std::abs(facing) < 0.8f) // where the gap closes, its ends face along it
            continue;
        ++sides[facing > 0.f];
        // The lower slab's top faces up.
        wrong += (surface.under.positions[v] ^ up) * facing > 0.f || (surface.under.normals[v] ^ up) * facing < 0.f;
    }
    EXPECT_GT(std::min(sides[0], sides[1]), 1000u);
    EXPECT_EQ(wrong, 0u);
}

} // namespace
} // namespace patina
