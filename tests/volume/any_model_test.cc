// Any model: the metal is where a person would say it is.

#include "base/errors.h"
#include "support/test_meshes.h"
#include "support/test_surfaces.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/mesh_repair.h"
#include "surface/shapes.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace patina {
namespace {

using Imath::V3f;

/// A cube of 12 triangles, facing outward (inward where turned).
void addCube(Mesh& mesh, float half, const V3f& middle = V3f(0.f), bool turned = false) {
    const int first = static_cast<int>(mesh.positions.size());
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(middle + V3f(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half));
    const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads)
        for (const int i : {0, 1, 2, 0, 2, 3}) {
            mesh.faceVertices.push_back(first + q[i]);
            if (mesh.faceVertices.size() % 3 == 0)
                mesh.faceSizes.push_back(3);
        }
    if (turned)
        for (std::size_t f = mesh.faceCount() - 12; f < mesh.faceCount(); ++f)
            std::swap(mesh.faceVertices[3 * f + 1], mesh.faceVertices[3 * f + 2]);
}

std::unique_ptr<test::Piece> pieceOf(const Mesh& mesh, double voxelSize = 1.0) {
    VolumeScale scale = test::voxelScale();
    scale.voxelSize = voxelSize;
    LimitSurfaceOptions limit;
    limit.targetEdge = 1.5 * voxelSize;
    return test::makePiece(makeLimitSurface(mesh, limit), scale);
}

/// Voxels in the metal, counted one by one.
std::size_t metalVoxels(const test::Piece& piece) {
    const auto& grid = *piece.volume->grids().base;
    const auto box = grid.evalActiveVoxelBoundingBox();
    const auto accessor = grid.getConstAccessor();
    std::size_t count = 0;
    for (auto c = box.begin(); c != box.end(); ++c)
        count += accessor.getValue(*c) < 0.f;
    return count;
}

constexpr std::size_t cubed(std::size_t n) {
    return n * n * n;
}

TEST(AnyModel, ACubeIsFull) {
    Mesh mesh;
    addCube(mesh, 15.3f);
    EXPECT_EQ(metalVoxels(*pieceOf(mesh)), cubed(31));
}

TEST(AnyModel, ACavityIsAirAndASolidInASolidIsNot) {
    Mesh cavity;
    addCube(cavity, 15.3f);
    addCube(cavity, 6.3f, V3f(0.f), true);
    EXPECT_EQ(metalVoxels(*pieceOf(cavity)), cubed(31) - cubed(13));
    Mesh solid;
    addCube(solid, 15.3f);
    addCube(solid, 6.3f);
    EXPECT_EQ(metalVoxels(*pieceOf(solid)), cubed(31));
}

TEST(AnyModel, ALargeCavityHasAMiddleOfAir) {
    Mesh mesh;
    addCube(mesh, 40.3f);
    addCube(mesh, 30.3f, V3f(0.f), true);
    const auto piece = pieceOf(mesh);
    EXPECT_EQ(metalVoxels(*piece), cubed(81) - cubed(61));
    EXPECT_GT(piece->volume->grids().base->tree().getValue(piece->volume->grids().space.index(0, 0, 0)), 0.f);
    EXPECT_LT(piece->volume->grids().base->tree().getValue(piece->volume->grids().space.index(35, 0, 0)), 0.f);
    EXPECT_NEAR(piece->volume->grids().base->tree().getValue(piece->volume->grids().space.index(29, 0, 0)), 1.3, 1e-4);
}

TEST(AnyModel, TwoCubesThatOverlapAreTheirUnion) {
    Mesh mesh;
    addCube(mesh, 15.3f);
    addCube(mesh, 15.3f, V3f(12.f, 5.f, 3.f));
    const auto piece = pieceOf(mesh);
    EXPECT_EQ(metalVoxels(*piece), 2 * cubed(31) - 19 * 26 * 28);
    // The parts of faces that lie in the metal are no surface: in the overlap's middle nothing is near.
    const auto& tree = piece->volume->grids().base->tree();
    const IndexSpace& space = piece->volume->grids().space;
    EXPECT_LE(tree.getValue(space.index(-3, 5, 3)), -4.f);
    EXPECT_FALSE(tree.isValueOn(space.index(-3, 5, 3)));
    // Where the face leaves the metal, its distance is still exact: x = -3.3 is inside, x = 27.3 the far side.
    EXPECT_NEAR(tree.getValue(space.index(26, 5, 3)), -1.3, 1e-4);
    EXPECT_NEAR(tree.getValue(space.index(20, 20, 19)), -0.3, 1.01); // next to an edge of the second cube
}

TEST(AnyModel, InsideOutIsRepairedToTheSameMetal) {
    Mesh mesh;
    addCube(mesh, 15.3f, V3f(0.f), true);
    addCube(mesh, 6.3f);
    std::swap(mesh.faceVertices[1], mesh.faceVertices[2]); // and one face against its neighbours
    repairMesh(mesh, RepairMode::automatic);
    EXPECT_EQ(metalVoxels(*pieceOf(mesh)), cubed(31) - cubed(13));
}

TEST(AnyModel, ACubeWithAHoleIsFullOnceTheHoleIsClosed) {
    Mesh mesh;
    addCube(mesh, 15.3f);
    mesh.faceSizes.pop_back();
    mesh.faceVertices.resize(33);
    EXPECT_FALSE(repairMesh(mesh, RepairMode::holes).holes.empty());
    EXPECT_EQ(metalVoxels(*pieceOf(mesh)), cubed(31));
}

TEST(AnyModel, AnOpenBoxIsASheetWithMetalBehindIt) {
    Mesh mesh;
    addCube(mesh, 20.3f);
    mesh.faceSizes.resize(10);
    mesh.faceVertices.resize(30);
    repairMesh(mesh, RepairMode::automatic);
    const auto piece = pieceOf(mesh);
    const auto& tree = piece->volume->grids().base->tree();
    const IndexSpace& space = piece->volume->grids().space;
    EXPECT_GT(tree.getValue(space.index(0, 0, 0)), 0.f);    // hollow
    EXPECT_LT(tree.getValue(space.index(-18, 0, 0)), 0.f);  // wall
    EXPECT_GT(tree.getValue(space.index(-22, 0, 0)), 0.f);  // outside
}

TEST(AnyModel, AFinStandsOnItsCube) {
    Mesh mesh;
    addCube(mesh, 15.3f);
    mesh.positions.emplace_back(-15.3f, 35.3f, 15.3f);
    mesh.positions.emplace_back(15.3f, 35.3f, 15.3f);
    for (const int v : {6, 7, 9, 6, 9, 8})
        mesh.faceVertices.push_back(v);
    mesh.faceSizes.insert(mesh.faceSizes.end(), 2, 3);
    repairMesh(mesh, RepairMode::automatic);
    const auto piece = pieceOf(mesh);
    const auto& tree = piece->volume->grids().base->tree();
    const IndexSpace& space = piece->volume->grids().space;
    EXPECT_LT(tree.getValue(space.index(0, 0, 0)), 0.f);
    for (int x = -14; x <= 14; ++x)
        for (int y = -14; y <= 14; ++y)
            EXPECT_LT(tree.getValue(space.index(x, y, 0)), 0.f);
    // The fin has metal on one side and air on the other.
    EXPECT_NE(tree.getValue(space.index(0, 27, 13)) < 0.f, tree.getValue(space.index(0, 27, 17)) < 0.f);
}

TEST(AnyModel, ASheetsBackStaysClearOfWhatLiesBehindIt) {
    // A sheet five voxels above a cube, facing up.
    Mesh mesh;
    addCube(mesh, 15.3f);
    const int first = 8, n = 10;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            mesh.positions.emplace_back(4.f * (i - n / 2), 4.f * (j - n / 2), 20.3f);
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = first + j * (n + 1) + i;
            for (const int v : {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1})
                mesh.faceVertices.push_back(v);
            mesh.faceSizes.insert(mesh.faceSizes.end(), 2, 3);
        }
    const SurfaceMesh surface = makeLimitSurface(mesh, {});
    ASSERT_FALSE(surface.closed);
    const ClosedSurface closed = closeSurface(surface, 8.0);
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        const V3f &front = surface.positions[v], &back = closed.positions[v + surface.positions.size()];
        if (front.z < 20.f)
            continue;
        if (std::abs(front.x) < 15.f && std::abs(front.y) < 15.f) {
            EXPECT_NEAR(back.z, 17.8f, 1e-4f);
        }
        EXPECT_GE(back.z, 12.3f - 1e-4f);
        EXPECT_LE(back.z, 17.8f + 1e-4f);
    }
    // Between the two there is air.
    const auto piece = pieceOf(mesh);
    const auto& tree = piece->volume->grids().base->tree();
    const IndexSpace& space = piece->volume->grids().space;
    EXPECT_LT(tree.getValue(space.index(0, 0, 19)), 0.f);
    EXPECT_NEAR(tree.getValue(space.index(0, 0, 17)), 0.8, 0.1);
    EXPECT_LT(tree.getValue(space.index(0, 0, 14)), 0.f);
    // Only the sheet has a back, and a wall of two triangles at each of its open edges.
    EXPECT_EQ(closed.triangles.size() - closed.frontTriangles, 200u + 2 * 40);
}

TEST(AnyModel, AMoebiusStripBecomesVoxels) {
    Mesh strip = test::moebiusStrip(40.0, 10.0, 60);
    repairMesh(strip, RepairMode::automatic);
    const auto piece = pieceOf(strip);
    // About the strip's area (2 pi 40 · 20) times the back's eight voxels.
    EXPECT_NEAR(metalVoxels(*piece), 2 * 3.1416 * 40 * 20 * 8, 6000);
}

// --- models as people have them ---

struct Known {
    const char* file;
    double tolerance; ///< of the volume by the triangles
};

class SharedModel : public testing::TestWithParam<Known> {};

TEST_P(SharedModel, HoldsItsVolume) {
    const auto path = std::filesystem::path(PATINA_SOURCE_DIR) / ".." / "shared" / "data" / "meshes" / GetParam().file;
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "the model " << GetParam().file << " is not here";
    Mesh mesh = readMesh(path);
    repairMesh(mesh, RepairMode::automatic);
    const V3f size = mesh.bounds().size();
    const double voxelSize = std::max({size.x, size.y, size.z}) / 96.0;
    const auto piece = pieceOf(mesh, voxelSize);
    double volume = 0.0;
    for (const auto& t : piece->surface.triangles) {
        const Imath::V3d a(piece->surface.positions[t[0]]), b(piece->surface.positions[t[1]]),
            c(piece->surface.positions[t[2]]);
        volume += a.dot(b.cross(c)) / 6.0;
    }
    const double voxels = static_cast<double>(metalVoxels(*piece)) * voxelSize * voxelSize * voxelSize;
    EXPECT_NEAR(voxels / volume, 1.0, GetParam().tolerance);
}

// Parts that run into each other count twice in the triangles' volume: suzanne's eyes, the teapot's handle and lid.
INSTANTIATE_TEST_SUITE_P(Closed, SharedModel,
                         testing::Values(Known{"happy_buddha_60k_uv.obj", 0.01}, Known{"igea_268k.ply", 0.01},
                                         Known{"rocker_arm_genus1.obj", 0.01}, Known{"stanford_bunny_holes.obj", 0.01},
                                         Known{"spot_control_mesh.obj", 0.01}, Known{"spot_quadrangulated.obj", 0.01},
                                         Known{"suzanne.obj", 0.05}, Known{"teapot_open_patches.obj", 0.05}),
                         [](const auto& info) {
                             std::string name = info.param.file;
                             name = name.substr(0, name.find('.'));
                             return name;
                         });

TEST(AnyModel, ShapesOfMakeAreSound) {
    for (const std::string& name : shapeNames()) {
        Mesh mesh = makeShape(name);
        const MeshReport report = repairMesh(mesh, RepairMode::automatic);
        EXPECT_FALSE(report.repaired) << name;
        for (const std::string& warning : report.warnings)
            ADD_FAILURE() << name << ": " << warning;
    }
}

} // namespace
} // namespace patina
