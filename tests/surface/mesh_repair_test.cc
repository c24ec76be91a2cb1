#include "surface/mesh_repair.h"

#include "base/errors.h"
#include "support/test_meshes.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"
#include "surface/mesh_topology.h"
#include "surface/shapes.h"
#include "surface/winding_number.h"
#include "test_models.h"

#include <gmock/gmock.h>

#include <cmath>

namespace patina {
namespace {

using Imath::V3d;
using Imath::V3f;
using Imath::V3i;
using Kind = MeshReport::ShellKind;
using testing::HasSubstr;

/// Cube of the given half side around a middle, 12 triangles.
Mesh cubeAt(float half, const V3f& middle = V3f(0.f)) {
    Mesh quads = makeCube();
    Mesh mesh;
    mesh.name = "cube";
    for (const V3f& p : quads.positions)
        mesh.positions.push_back(p * half + middle);
    for (int f = 0; f < 6; ++f) {
        const int* c = quads.faceVertices.data() + 4 * f;
        for (const int i : {0, 1, 2, 0, 2, 3})
            mesh.faceVertices.push_back(c[i]);
    }
    mesh.faceSizes.assign(12, 3);
    return mesh;
}

void add(Mesh& mesh, const Mesh& other) {
    const int first = static_cast<int>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    mesh.faceSizes.insert(mesh.faceSizes.end(), other.faceSizes.begin(), other.faceSizes.end());
    for (const int v : other.faceVertices)
        mesh.faceVertices.push_back(v + first);
}

void turn(Mesh& mesh, std::size_t face) {
    std::swap(mesh.faceVertices[3 * face + 1], mesh.faceVertices[3 * face + 2]);
}
Mesh turnedOver(Mesh mesh) {
    for (std::size_t f = 0; f < mesh.faceCount(); ++f)
        turn(mesh, f);
    return mesh;
}

/// Six times the volume, by the faces' winding.
double volumeOf(const Mesh& mesh) {
    const SurfaceMesh surface = makeLimitSurface(mesh, {SubdivisionScheme::none, 0, 0.0});
    double sum = 0.0;
    for (const V3i& t : surface.triangles)
        sum += V3d(surface.positions[t.x]).dot(V3d(surface.positions[t.y]).cross(V3d(surface.positions[t.z])));
    return sum / 6.0;
}

bool isClosed(const Mesh& mesh) {
    return makeLimitSurface(mesh, {SubdivisionScheme::none, 0, 0.0}).closed;
}

std::string all(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines)
        text += line + "\n";
    return text;
}

TEST(WindingNumber, isOneInsideASphereAndNoughtOutside) {
    const Mesh sphere = makeShape("sphere");
    const SurfaceMesh surface = makeLimitSurface(sphere, {SubdivisionScheme::automatic, 4, 0.0});
    const auto box = surface.bounds();
    const V3d middle(box.center());
    const double radius = 0.5 * box.size().x;
    const WindingNumber winding(surface.positions, surface.triangles);
    for (int i = 0; i < 200; ++i) {
        const V3d way = V3d(std::sin(i * 1.7), std::cos(i * 2.3), std::sin(i * 0.7 + 1)).normalized();
        for (const double r : {0.1, 0.6, 0.95, 0.99})
            EXPECT_NEAR(winding.at(middle + way * (radius * r)), 1.0, 0.02) << r;
        for (const double r : {1.01, 1.05, 2.0, 10.0})
            EXPECT_NEAR(winding.at(middle + way * (radius * r)), 0.0, 0.02) << r;
    }
}

TEST(WindingNumber, ofAnOpenCubeIsWhatItsFacesSubtend) {
    Mesh mesh = cubeAt(1.f);
    const SurfaceMesh whole = makeLimitSurface(mesh, {SubdivisionScheme::none, 0, 0.0});
    std::vector<V3i> five(whole.triangles.begin(), whole.triangles.end() - 2);
    EXPECT_NEAR(WindingNumber(whole.positions, five).at(V3d(0.0)), 5.0 / 6.0, 1e-12);
    EXPECT_NEAR(WindingNumber(whole.positions, five).at(V3d(-3.0, 0.2, 0.1)), -4e-3, 4e-2);
}

TEST(MeshRepair, leavesASoundModelAsItIs) {
    Mesh cube = cubeAt(1.f);
    const std::vector<int> before = cube.faceVertices;
    const MeshReport report = repairMesh(cube, RepairMode::none);
    EXPECT_EQ(cube.faceVertices, before);
    EXPECT_FALSE(report.repaired);
    EXPECT_TRUE(report.warnings.empty());
    ASSERT_EQ(report.shells.size(), 1u);
    EXPECT_EQ(report.shells[0].kind, Kind::solid);
    EXPECT_NEAR(report.shells[0].volume, 8.0, 1e-9);
    EXPECT_NEAR(report.shells[0].area, 24.0, 1e-9);
}

TEST(MeshRepair, turnsSingleFacesLikeTheirNeighbours) {
    Mesh cube = cubeAt(1.f);
    turn(cube, 4);
    Mesh strict = cube;
    const MeshReport report = repairMesh(cube, RepairMode::automatic);
    EXPECT_EQ(report.turnedFaces.count, 1u);
    EXPECT_THAT(all(report.warnings), HasSubstr("face 5, at ("));
    EXPECT_NEAR(volumeOf(cube), 8.0, 1e-6);
    try {
        repairMesh(strict, RepairMode::none);
        FAIL() << "was accepted";
    } catch (const ModelError& error) {
        EXPECT_EQ(error.code(), ExitCode::model);
        EXPECT_THAT(error.message(), HasSubstr("face 5"));
    }
}

TEST(MeshRepair, turnsOverAModelThatIsInsideOut) {
    Mesh cube = turnedOver(cubeAt(1.f));
    EXPECT_LT(volumeOf(cube), 0.0);
    const MeshReport report = repairMesh(cube, RepairMode::automatic);
    EXPECT_TRUE(report.shells[0].turnedOver);
    EXPECT_THAT(all(report.warnings), HasSubstr("inside out"));
    EXPECT_NEAR(volumeOf(cube), 8.0, 1e-6);
}

TEST(MeshRepair, aShellInsideAnotherIsACavityOrHidden) {
    for (const bool whole : {false, true}) {
        Mesh cavity = cubeAt(2.f);
        add(cavity, turnedOver(cubeAt(1.f)));
        if (whole) // everything inside out: the same once turned over
            cavity = turnedOver(cavity);
        MeshReport report = repairMesh(cavity, RepairMode::automatic);
        ASSERT_EQ(report.shells.size(), 2u);
        EXPECT_EQ(report.shells[0].kind, Kind::solid);
        EXPECT_EQ(report.shells[1].kind, Kind::cavity);
        EXPECT_EQ(report.repaired, whole);
        EXPECT_NEAR(volumeOf(cavity), 64.0 - 8.0, 1e-5);
    }
    Mesh nested = cubeAt(2.f);
    add(nested, cubeAt(1.f));
    const MeshReport report = repairMesh(nested, RepairMode::automatic);
    EXPECT_EQ(report.shells[1].kind, Kind::hidden);
    EXPECT_FALSE(report.repaired);
}

TEST(MeshRepair, anIslandInACavityIsSolid) {
    Mesh mesh = cubeAt(3.f);
    add(mesh, turnedOver(cubeAt(2.f)));
    add(mesh, cubeAt(1.f));
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    ASSERT_EQ(report.shells.size(), 3u);
    EXPECT_EQ(report.shells[1].kind, Kind::cavity);
    EXPECT_EQ(report.shells[2].kind, Kind::solid);
    EXPECT_FALSE(report.repaired);
}

TEST(MeshRepair, closesASmallHoleAndSaysWhere) {
    SurfaceMesh fine = makeLimitSurface(makeCube(), {SubdivisionScheme::catmullClark, 4, 0.0});
    Mesh mesh;
    mesh.name = "pebble";
    mesh.positions = fine.positions;
    for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
        if (t == 100 || t == 101)
            continue;
        mesh.faceSizes.push_back(3);
        for (int c = 0; c < 3; ++c)
            mesh.faceVertices.push_back(fine.triangles[t][c]);
    }
    ASSERT_FALSE(isClosed(mesh));
    const std::size_t faces = mesh.faceCount();
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    EXPECT_TRUE(isClosed(mesh));
    ASSERT_EQ(report.holes.size(), 1u);
    EXPECT_TRUE(report.holes[0].closed);
    EXPECT_EQ(report.holes[0].edges, mesh.faceCount() - faces + 2);
    EXPECT_THAT(all(report.warnings), HasSubstr("a hole of"));
    EXPECT_THAT(all(report.warnings), HasSubstr("vertex"));
}

TEST(MeshRepair, anOpenBoxStaysASheetUnlessToldOtherwise) {
    Mesh box = cubeAt(1.f);
    box.faceSizes.resize(10);
    box.faceVertices.resize(30);
    Mesh closed = box;
    const MeshReport sheet = repairMesh(box, RepairMode::automatic);
    EXPECT_EQ(sheet.shells[0].kind, Kind::sheet);
    EXPECT_THAT(all(sheet.warnings), HasSubstr("--repair holes"));
    const MeshReport solid = repairMesh(closed, RepairMode::holes);
    EXPECT_EQ(solid.shells[0].kind, Kind::solid);
    EXPECT_NEAR(volumeOf(closed), 8.0, 1e-6);
}

TEST(MeshRepair, aFlatSheetIsASheetInEveryMode) {
    for (const RepairMode mode : {RepairMode::automatic, RepairMode::holes, RepairMode::sheet, RepairMode::none}) {
        Mesh sheet = makeSheet(8, 4);
        const MeshReport report = repairMesh(sheet, mode);
        ASSERT_EQ(report.shells.size(), 1u);
        EXPECT_EQ(report.shells[0].kind, Kind::sheet);
        EXPECT_EQ(report.shells[0].openEdges, 24u);
        EXPECT_FALSE(report.repaired);
    }
}

TEST(MeshRepair, aFinIsASheetOnItsBody) {
    Mesh mesh = cubeAt(1.f);
    // Two more triangles stand on the edge between (-1, 1, 1) and (1, 1, 1).
    mesh.positions.emplace_back(-1.f, 2.f, 2.f);
    mesh.positions.emplace_back(1.f, 2.f, 2.f);
    mesh.faceSizes.insert(mesh.faceSizes.end(), 2, 3);
    for (const int v : {6, 7, 9, 6, 9, 8})
        mesh.faceVertices.push_back(v);
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    EXPECT_EQ(report.crowdedEdges.count, 1u);
    ASSERT_EQ(report.shells.size(), 2u);
    EXPECT_EQ(report.shells[0].kind, Kind::solid);
    EXPECT_NEAR(report.shells[0].volume, 8.0, 1e-9);
    EXPECT_EQ(report.shells[1].kind, Kind::sheet);
    EXPECT_THAT(all(report.warnings), HasSubstr("vertices 8 and 7, at (1, 1, 1)"));
}

TEST(MeshRepair, aWallBetweenTwoRoomsLeavesOneSolid) {
    // Two cubes side by side, each with its own copy of the wall between them.
    Mesh mesh = cubeAt(1.f);
    add(mesh, cubeAt(1.f, V3f(2.f, 0.f, 0.f)));
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    double volume = 0.0;
    for (const auto& shell : report.shells) {
        EXPECT_NE(shell.kind, Kind::sheet);
        volume += shell.volume;
    }
    EXPECT_NEAR(volume, 16.0, 1e-6);
    EXPECT_NEAR(volumeOf(mesh), 16.0, 1e-6);
}

TEST(MeshRepair, copiesOfFacesGo) {
    Mesh mesh = cubeAt(1.f);
    for (const int v : {mesh.faceVertices[4], mesh.faceVertices[5], mesh.faceVertices[3]})
        mesh.faceVertices.push_back(v); // face 2 once more, from another corner on
    mesh.faceSizes.push_back(3);
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    EXPECT_EQ(report.copiedFaces.count, 1u);
    EXPECT_THAT(report.copiedFaces.where, HasSubstr("face 13"));
    EXPECT_EQ(mesh.faceCount(), 12u);
    EXPECT_TRUE(isClosed(mesh));
}

TEST(MeshRepair, aSheetWithBothSidesModelledKeepsItsFront) {
    Mesh mesh = makeSheet(3, 3);
    mesh.uvs.clear();
    mesh.faceUvs.clear();
    const std::vector<int> front = mesh.faceVertices;
    for (int f = 0; f < 9; ++f) {
        mesh.faceSizes.push_back(4);
        for (int i = 3; i >= 0; --i)
            mesh.faceVertices.push_back(front[4 * f + i]);
    }
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    EXPECT_EQ(mesh.faceVertices, front);
    ASSERT_EQ(report.shells.size(), 1u);
    EXPECT_EQ(report.shells[0].kind, Kind::sheet);
}

TEST(MeshRepair, aMoebiusStripIsASheetThatIsToldOf) {
    Mesh strip = test::moebiusStrip(1.0, 0.3, 24);
    const MeshReport report = repairMesh(strip, RepairMode::automatic);
    EXPECT_GE(report.oneSidedEdges.count, 1u);
    EXPECT_THAT(all(report.warnings), HasSubstr("Möbius"));
    ASSERT_EQ(report.shells.size(), 1u);
    EXPECT_EQ(report.shells[0].kind, Kind::sheet);
}

TEST(MeshRepair, twoCubesAtOneVertexAreTwoSolids) {
    Mesh mesh = cubeAt(1.f);
    add(mesh, cubeAt(1.f, V3f(2.f)));
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    EXPECT_EQ(report.shells.size(), 2u);
    EXPECT_EQ(report.pinchedVertices.count, 1u);
    EXPECT_THAT(report.pinchedVertices.where, HasSubstr("(1, 1, 1)"));
    EXPECT_FALSE(report.repaired);
}

TEST(MeshRepair, aVertexOnAnEdgeIsACrackAndIsClosed) {
    // One face of the cube is cut at the middle of an edge that its neighbour keeps whole.
    Mesh mesh = cubeAt(1.f);
    const int a = mesh.faceVertices[0], b = mesh.faceVertices[1], c = mesh.faceVertices[2];
    mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5f);
    mesh.faceVertices[1] = 8;
    mesh.faceSizes.push_back(3);
    for (const int v : {8, b, c})
        mesh.faceVertices.push_back(v);
    const MeshReport report = repairMesh(mesh, RepairMode::automatic);
    ASSERT_EQ(report.holes.size(), 1u);
    EXPECT_TRUE(report.holes[0].crack);
    EXPECT_TRUE(isClosed(mesh));
    EXPECT_NEAR(volumeOf(mesh), 8.0, 1e-6);
    EXPECT_THAT(all(report.warnings), HasSubstr("cracks"));
}

TEST(MeshRepair, verticesSplitAlongSeamsAreJoinedBeforeSubdivision) {
    Mesh cube = makeCube(), split;
    for (std::size_t c = 0; c < cube.faceVertices.size(); ++c) {
        split.positions.push_back(cube.positions[cube.faceVertices[c]]);
        split.faceVertices.push_back(static_cast<int>(c));
    }
    split.faceSizes.assign(6, 4);
    repairMesh(split, RepairMode::automatic);
    EXPECT_TRUE(makeLimitSurface(split, {SubdivisionScheme::catmullClark, 2, 0.0}).closed);
}

TEST(MeshRepair, holesOfAModelWithUvsGetNoPlaceInThem) {
    Mesh mesh = cubeAt(1.f);
    for (const int v : mesh.faceVertices)
        mesh.faceUvs.push_back(v);
    for (int v = 0; v < 8; ++v)
        mesh.uvs.emplace_back(0.1f * v, 0.05f * v);
    mesh.faceSizes.resize(11);
    mesh.faceVertices.resize(33);
    mesh.faceUvs.resize(33);
    repairMesh(mesh, RepairMode::holes);
    ASSERT_EQ(mesh.faceCount(), 12u);
    EXPECT_EQ(mesh.faceUvs.size(), mesh.faceVertices.size());
    EXPECT_EQ(mesh.faceUvs[33], mesh.faceUvs[34]);
    EXPECT_TRUE(isClosed(mesh));
}

TEST(WallCheck, saysHowManyVoxelsAThinPlateNeeds) {
    Mesh plate = cubeAt(1.f);
    for (V3f& p : plate.positions)
        p.z *= 0.01f;
    MeshReport report = repairMesh(plate, RepairMode::automatic);
    const SurfaceMesh surface = makeLimitSurface(plate, {SubdivisionScheme::none, 0, 0.0});
    checkWalls(surface, 2.0 / 64, 2.0, report); // 64 voxels: the plate is 0.64 thick
    EXPECT_GT(report.thinWalls.fraction, 0.9);
    EXPECT_NEAR(report.thinWalls.thinnest, 0.02, 1e-6);
    EXPECT_THAT(all(report.warnings), HasSubstr("--voxels 20"));
    report = {};
    checkWalls(surface, 2.0 / 250, 2.0, report);
    EXPECT_TRUE(report.warnings.empty());
}

TEST(WallCheck, findsFacesThatPierceEachOther) {
    Mesh mesh = cubeAt(1.f);
    add(mesh, cubeAt(1.f, V3f(1.1f, 0.3f, 0.2f)));
    MeshReport report;
    checkWalls(makeLimitSurface(mesh, {SubdivisionScheme::none, 0, 0.0}), 0.01, 3.0, report);
    EXPECT_GE(report.piercedFaces.count, 6u);
    EXPECT_THAT(report.piercedFaces.where, HasSubstr("faces"));
    MeshReport sound;
    checkWalls(makeLimitSurface(cubeAt(1.f), {SubdivisionScheme::none, 0, 0.0}), 0.01, 2.0, sound);
    EXPECT_EQ(sound.piercedFaces.count, 0u);
}

// --- models as people have them ---

MeshReport repairShared(const std::string& name, Mesh& mesh, RepairMode mode = RepairMode::automatic) {
    mesh = readMesh(sharedModel(name));
    return repairMesh(mesh, mode);
}
#define PATINA_REPAIR(name)                                                                                            \
    PATINA_NEEDS_MODEL(name);                                                                                          \
    Mesh mesh;                                                                                                         \
    const MeshReport report = repairShared(name, mesh);

TEST(SharedModels, soundOnesStayAsTheyAre) {
    for (const char* name :
         {"happy_buddha_60k_uv.obj", "igea_268k.ply", "rocker_arm_genus1.obj", "spot_quadrangulated.obj",
          "spot_control_mesh.obj"}) {
        PATINA_REPAIR(name);
        EXPECT_FALSE(report.repaired) << name << ": " << all(report.warnings);
        ASSERT_EQ(report.shells.size(), 1u) << name;
        EXPECT_EQ(report.shells[0].kind, Kind::solid) << name;
    }
}

TEST(SharedModels, theHolesOfTheBunnyAreClosed) {
    PATINA_REPAIR("stanford_bunny_holes.obj");
    ASSERT_EQ(report.shells.size(), 1u);
    EXPECT_EQ(report.shells[0].kind, Kind::solid);
    EXPECT_EQ(report.holes.size(), 5u);
    EXPECT_TRUE(isClosed(mesh));
    Mesh strict;
    EXPECT_THROW(repairShared("stanford_bunny_holes.obj", strict, RepairMode::none), ModelError);
    Mesh sheet;
    EXPECT_EQ(repairShared("stanford_bunny_holes.obj", sheet, RepairMode::sheet).shells[0].kind, Kind::sheet);
}

TEST(SharedModels, sheetsStaySheets) {
    for (const char* name : {"woody_flat_sheet.obj", "copper_strip_sheet.obj"}) {
        PATINA_REPAIR(name);
        EXPECT_FALSE(report.repaired) << name;
        EXPECT_TRUE(report.warnings.empty()) << all(report.warnings);
        ASSERT_EQ(report.shells.size(), 1u) << name;
        EXPECT_EQ(report.shells[0].kind, Kind::sheet) << name;
    }
}

TEST(SharedModels, theTeapotsPatchesBecomeSolids) {
    PATINA_REPAIR("teapot_open_patches.obj");
    ASSERT_EQ(report.shells.size(), 4u);
    for (const auto& shell : report.shells)
        EXPECT_EQ(shell.kind, Kind::solid);
    EXPECT_TRUE(isClosed(mesh)) << all(report.warnings);
}

TEST(SharedModels, suzannesHeadAndEyesAreSolid) {
    PATINA_REPAIR("suzanne.obj");
    ASSERT_EQ(report.shells.size(), 3u);
    for (const auto& shell : report.shells)
        EXPECT_EQ(shell.kind, Kind::solid) << all(report.warnings);
}

TEST(SharedModels, theBeetlesFaultsAreNamed) {
    PATINA_REPAIR("beetle_nonmanifold.obj");
    EXPECT_EQ(report.crowdedEdges.count, 47u);
    EXPECT_THAT(all(report.warnings), HasSubstr("edges of more than two faces: 47 (vertices"));
}

} // namespace
} // namespace patina
