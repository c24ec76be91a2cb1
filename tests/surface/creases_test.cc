// Creases and sharp corners: read, kept, and what they make of the limit surface.

#include "base/errors.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/mesh_repair.h"
#include "surface/region_cutter.h"
#include "test_models.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

using Imath::V3f;
using testing::HasSubstr;

LimitSurfaceOptions atLevel(int level) {
    LimitSurfaceOptions options;
    options.level = level;
    return options;
}

/// The four edges around the cube's face z = 1.
Mesh cubeWithLid(float sharpness) {
    Mesh mesh = makeCube();
    mesh.creases = {{4, 5, sharpness}, {5, 7, sharpness}, {7, 6, sharpness}, {6, 4, sharpness}};
    return mesh;
}

// A crease is a cubic B-spline of its own vertices: (a + 4 v + b) / 6 at a vertex, (a + 23 b + 23 c + d) / 48 in the
// middle of an edge. Around the lid of the cube of side 2: (2/3, 2/3, 1) and (11/12, 0, 1).
TEST(Creases, aSharpRingIsABSplineInItsPlane) {
    for (const int level : {1, 3}) {
        const SurfaceMesh surface = makeLimitSurface(cubeWithLid(10.f), atLevel(level));
        EXPECT_LT(distanceTo(surface, V3f(2.f / 3.f, 2.f / 3.f, 1.f)), 2e-6f);
        EXPECT_LT(distanceTo(surface, V3f(11.f / 12.f, 0.f, 1.f)), 2e-6f);
        // The other end of the cube is as smooth as ever, but for what the ring pulls up: its corners move only through
        // neighbours' neighbours.
        EXPECT_LT(distanceTo(surface, V3f(0.5f, 0.5f, -0.5f)), 2e-6f);
    }
}

TEST(Creases, aCubeOfSharpEdgesStaysACube) {
    Mesh mesh = makeCube();
    for (int a = 0; a < 8; ++a)
        for (const int bit : {1, 2, 4})
            if (!(a & bit))
                mesh.creases.push_back({a, a | bit, 10.f});
    ASSERT_EQ(mesh.creases.size(), 12u);
    const SurfaceMesh surface = makeLimitSurface(mesh, atLevel(3));
    for (const V3f& p : surface.positions)
        EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1.f, 1e-6f);
    EXPECT_LT(distanceTo(surface, V3f(1.f, 1.f, 1.f)), 1e-6f);
}

TEST(Creases, aSharpCornerStaysWhereItIs) {
    Mesh mesh = makeCube();
    mesh.corners = {{7, 10.f}};
    const SurfaceMesh surface = makeLimitSurface(mesh, atLevel(3));
    EXPECT_LT(distanceTo(surface, V3f(1.f, 1.f, 1.f)), 1e-6f);
    EXPECT_LT(distanceTo(surface, V3f(-0.5f, -0.5f, -0.5f)), 2e-6f);
}

// Sharpness 1 is one sharp step and then none (DeRose, Kass & Truong 1998). After the first, the corner is
// (3/4, 3/4, 1), its edge neighbours (0, 1, 1), (1, 0, 1) and (3/4, 3/4, 0), its diagonal ones the middles of the
// faces. The limit of a vertex of valence 3, (9 v + 4 Σ e + Σ f) / 24, is then (59/96, 59/96, 3/4).
TEST(Creases, aSharpnessOfOneLastsOneStep) {
    const SurfaceMesh surface = makeLimitSurface(cubeWithLid(1.f), atLevel(3));
    EXPECT_LT(distanceTo(surface, V3f(59.f / 96.f, 59.f / 96.f, 0.75f)), 2e-6f);
    EXPECT_GT(distanceTo(makeLimitSurface(makeCube(), atLevel(3)), V3f(59.f / 96.f, 59.f / 96.f, 0.75f)), 0.1f);
}

// What is chosen by itself is deep enough for a crease to end.
TEST(Creases, theLevelReachesTheEndOfTheLongestCrease) {
    LimitSurfaceOptions coarse;
    coarse.targetEdge = 2.0; // one step would do
    const SurfaceMesh surface = makeLimitSurface(cubeWithLid(3.f), coarse);
    const SurfaceMesh deep = makeLimitSurface(cubeWithLid(3.f), atLevel(6));
    ASSERT_EQ(surface.positions.size(), makeLimitSurface(makeCube(), atLevel(3)).positions.size());
    for (const V3f& p : surface.positions)
        EXPECT_LT(distanceTo(deep, p), 2e-5f);
}

// A close-up is cut out step by step, and each step leaves what remains of the sharpness to the next.
TEST(Creases, aCloseUpHasThemToo) {
    LimitSurfaceOptions options;
    const auto closeUp = [&](const Mesh& mesh, const V3f& middle) {
        const Imath::V3d half(0.06), at(middle);
        return RegionCutter(mesh, options).near(Imath::Box3d(at - half, at + half), Imath::V3d(0.0), 0.01);
    };
    const V3f sharp(2.f / 3.f, 2.f / 3.f, 1.f), blunt(59.f / 96.f, 59.f / 96.f, 0.75f);
    EXPECT_LT(distanceTo(closeUp(cubeWithLid(10.f), sharp), sharp), 2e-6f);
    EXPECT_LT(distanceTo(closeUp(cubeWithLid(1.f), blunt), blunt), 2e-6f);
    Mesh pointed = makeCube();
    pointed.corners = {{7, 10.f}};
    EXPECT_LT(distanceTo(closeUp(pointed, V3f(1.f)), V3f(1.f)), 2e-6f);
    EXPECT_TRUE(closeUp(makeCube(), V3f(1.f)).triangles.empty()); // the smooth cube does not come there
}

const char* const taggedCube = "v 9 9 9\n" // in no face: what comes after is counted from it all the same
                               "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
                               "f 2 4 5 3\nf 6 7 9 8\nf 2 3 7 6\nf 4 8 9 5\nf 2 6 8 4\nf 3 5 9 7\n"
                               "t interpolateboundary 1/0/0 2\n"
                               "t crease 2/1/0 5 6 10\nt crease 4/2/0 6 8 8 7 10 12\nt crease 2/1/0 7 5 10\n"
                               "t corner 1/1/0 1 2.5\n";

TEST(Creases, tagsOfObjAreRead) {
    const TemporaryFile file("cube.obj", taggedCube);
    const Mesh mesh = readMesh(file.path());
    ASSERT_EQ(mesh.creases.size(), 4u);
    EXPECT_EQ(mesh.creases[2].a, 7); // the vertex that no face uses is gone
    EXPECT_EQ(mesh.creases[2].b, 6);
    for (const Crease& crease : mesh.creases)
        EXPECT_EQ(crease.sharpness, 10.f); // 12 is 10: for ever
    ASSERT_EQ(mesh.corners.size(), 1u);
    EXPECT_EQ(mesh.corners[0].vertex, 0);
    EXPECT_EQ(mesh.corners[0].sharpness, 2.5f);
    EXPECT_LT(distanceTo(makeLimitSurface(mesh, atLevel(2)), V3f(2.f / 3.f, 2.f / 3.f, 1.f)), 2e-6f);
}

TEST(Creases, writtenAndReadTheyAreTheSame) {
    Mesh mesh = cubeWithLid(1.3f);
    mesh.corners = {{0, 0.7f}};
    const TemporaryFile file("cube.obj", "");
    writeObj(mesh, file.path());
    const Mesh read = readMesh(file.path());
    ASSERT_EQ(read.creases.size(), mesh.creases.size());
    for (std::size_t i = 0; i < mesh.creases.size(); ++i) {
        EXPECT_EQ(read.creases[i].a, mesh.creases[i].a);
        EXPECT_EQ(read.creases[i].b, mesh.creases[i].b);
        EXPECT_EQ(read.creases[i].sharpness, mesh.creases[i].sharpness);
    }
    ASSERT_EQ(read.corners.size(), 1u);
    EXPECT_EQ(read.corners[0].sharpness, 0.7f);
}

// A face wound the wrong way round, and the cube's front apart from its sides along split vertices: both are mended,
// and creases follow.
TEST(Creases, repairKeepsThem) {
    Mesh mesh = cubeWithLid(10.f);
    std::reverse(mesh.faceVertices.begin(), mesh.faceVertices.begin() + 4);
    for (int i = 4; i < 8; ++i)
        mesh.positions.push_back(mesh.positions[i]); // 8…11 are 4…7 once more
    for (int corner = 4; corner < 8; ++corner)
        mesh.faceVertices[corner] += 4;
    mesh.creases = {{8, 9, 10.f}, {9, 11, 10.f}, {11, 10, 10.f}, {10, 8, 10.f}};
    repairMesh(mesh, RepairMode::automatic);
    EXPECT_LT(distanceTo(makeLimitSurface(mesh, atLevel(2)), V3f(2.f / 3.f, 2.f / 3.f, 1.f)), 2e-6f);
}

TEST(Creases, brokenTagsNameTheirLine) {
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 4 3 2\n";
    const auto errorOf = [&](const std::string& tag) -> std::string {
        const TemporaryFile file("a.obj", triangle + tag + "\n");
        try {
            readMesh(file.path());
        } catch (const ModelError& error) {
            return error.what();
        }
        ADD_FAILURE() << "'" << tag << "' was accepted";
        return {};
    };
    EXPECT_THAT(errorOf("t crease 2/1/0 0 3 1"), HasSubstr("a.obj:7: there is no edge between the vertices 0 and 3"));
    EXPECT_THAT(errorOf("t crease 2/1/0 0 4 1"), HasSubstr("vertex 4 is sharp, but there are 4, counted from 0"));
    EXPECT_THAT(errorOf("t corner 1/1/0 9 1"), HasSubstr("vertex 9 is sharp"));
    for (const char* tag :
         {"t crease 2/1/0 0 1", "t crease 2/1/0 0 x 1", "t crease 2/1/0 0 1 nan", "t crease 2/1/0 0 1 -1",
          "t crease 3/1/0 0 1 2 1", "t crease 2 0 1 1", "t crease 2/1/0 1 1 1", "t crease",
          "t crease 4/3/0 0 1 1 2 1 1 1", "t crease 2/1/0 -1 1 1", "t crease 99999999999/1/0 0 1 1"})
        EXPECT_THAT(errorOf(tag), HasSubstr("a.obj:7: this is no crease"));
    EXPECT_THAT(errorOf("t corner 1/1/0 0"), HasSubstr("a.obj:7: this is no corner"));
}

// Normals of scans stand in the OBJ and change nothing of what is read.
TEST(ObjNormals, areWrittenWhereGivenAndDoNotDisturb) {
    const SurfaceMesh surface = makeLimitSurface(makeSheet(2, 1), {SubdivisionScheme::none, -1, 0});
    const Mesh sheet = makeSheet(2, 1);
    const TemporaryFile file("sheet.obj", "");
    writeObj(sheet, file.path(), &surface.normals);
    std::ifstream stream(file.path());
    const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    EXPECT_THAT(text, HasSubstr("vn 0 0 1\n"));
    EXPECT_THAT(text, HasSubstr("f 1/1/1 2/2/2 5/5/5 4/4/4\n"));
    const Mesh read = readMesh(file.path());
    EXPECT_EQ(read.positions, sheet.positions);
    EXPECT_EQ(read.faceVertices, sheet.faceVertices);
    ASSERT_EQ(read.faceUvs.size(), sheet.faceUvs.size());
    for (std::size_t i = 0; i < read.faceUvs.size(); ++i)
        EXPECT_EQ(read.uvs[read.faceUvs[i]], sheet.uvs[sheet.faceUvs[i]]);
    const std::vector<V3f> tooFew(1);
    EXPECT_THROW(writeObj(sheet, file.path(), &tooFew), RunError);
}

} // namespace
} // namespace patina
