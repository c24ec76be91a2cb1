#include "surface/mesh_file.h"

#include "base/errors.h"
#include "surface/limit_surface.h"
#include "test_models.h"

#include <gmock/gmock.h>

#include <cstring>
#include <iterator>
#include <limits>

namespace patina {
namespace {

using Imath::V2f;
using Imath::V3f;
using testing::ElementsAre;
using testing::HasSubstr;

Mesh readText(const std::string& name, const std::string& text) {
    const TemporaryFile file(name, text);
    return readMesh(file.path());
}

/// The message of the error; "" (and a failure) without one.
std::string errorOf(const std::filesystem::path& path) {
    try {
        readMesh(path);
    } catch (const ModelError& error) {
        EXPECT_EQ(error.code(), ExitCode::model);
        EXPECT_FALSE(error.remedy().empty()) << error.what();
        EXPECT_THAT(error.place(), HasSubstr(path.filename().string()));
        return error.what();
    }
    ADD_FAILURE() << path << " was accepted";
    return {};
}

std::string errorOf(const std::string& name, const std::string& text) {
    const TemporaryFile file(name, text);
    return errorOf(file.path());
}

void append(std::string& bytes, float value) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    bytes.append(raw, 4);
}

std::string binaryStl(const std::vector<V3f>& corners, const std::string& title = "made by a test") {
    std::string bytes = title;
    bytes.resize(80, ' ');
    const auto count = static_cast<std::uint32_t>(corners.size() / 3);
    bytes.append(reinterpret_cast<const char*>(&count), 4);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        bytes.append(12, '\0');
        for (int j = 0; j < 3; ++j)
            for (int axis = 0; axis < 3; ++axis)
                append(bytes, corners[i + j][axis]);
        bytes.append(2, '\0');
    }
    return bytes;
}

const std::vector<V3f> twoTriangles = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST(MeshFile, objReadsEveryFormOfCorner) {
    const Mesh mesh = readText("forms.OBJ", "# a comment\nmtllib missing.mtl\nv 0 0 0\nv 1 0 0\r\nv 1 1 0\nv 0 1 0\n"
                                            "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl none\n"
                                            "f 1/1 2/2 3/3\nf 1/1/1 3/3/1 \\\n 4/2/1\nf -4/-3 -3/-2 -2/-1/-1\n");
    EXPECT_EQ(mesh.name, "forms");
    EXPECT_THAT(mesh.faceSizes, ElementsAre(3, 3, 3));
    EXPECT_THAT(mesh.faceVertices, ElementsAre(0, 1, 2, 0, 2, 3, 0, 1, 2));
    ASSERT_TRUE(mesh.hasUvs());
    EXPECT_EQ(mesh.uvs[mesh.faceUvs[2]], V2f(1, 1));
    EXPECT_EQ(mesh.uvs[mesh.faceUvs[5]], V2f(1, 0));
    EXPECT_EQ(mesh.faceUvs[6], mesh.faceUvs[0]);
}

TEST(MeshFile, objKeepsPolygonsDuplicatesAndNonManifoldEdges) {
    const Mesh mesh = readText("soup.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 2 0\nv 0 0 1\nv 9 9 9\n"
                                           "f 1 2 3 5 4\nf 1//1 2//1 6//1\nf 2 1 6\nf 1 2 6\nf 1 2 4\nvn 0 0 1\n");
    EXPECT_THAT(mesh.faceSizes, ElementsAre(5, 3, 3, 3, 3));
    EXPECT_EQ(mesh.positions.size(), 6u) << "the unreferenced vertex goes";
    EXPECT_FALSE(mesh.hasUvs());
}

TEST(MeshFile, repeatedCornersAreDroppedWithTheirUvs) {
    const Mesh mesh = readText("repeated.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                               "f 1/1 2/2 2/3 3/3 4/4\nf 1/1 2/2 1/1\nf 1/1\n");
    EXPECT_THAT(mesh.faceSizes, ElementsAre(4));
    ASSERT_TRUE(mesh.hasUvs());
    EXPECT_EQ(mesh.uvs[mesh.faceUvs[2]], V2f(1, 1));
}

TEST(MeshFile, objColoursAreAttributes) {
    const Mesh mesh = readText("colour.obj", "v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0.5\nv 0 1 0 0.25 0 0.5\nf 1 2 3\n");
    EXPECT_THAT(mesh.vertexAttributes.at("red"), ElementsAre(1.f, 0.f, 0.25f));
    EXPECT_THAT(mesh.vertexAttributes.at("blue"), ElementsAre(0.5f, 0.5f, 0.5f));
}

TEST(MeshFile, plyTextReadsCustomPropertiesOfAnyType) {
    const Mesh mesh =
        readText("custom.ply",
                 "ply\nformat ascii 1.0\ncomment hello\nelement vertex 4\nproperty double x\nproperty double y\n"
                 "property double z\nproperty uchar age\nproperty float wetness\nproperty uchar red\n"
                 "property uchar green\nproperty uchar blue\nelement face 2\nproperty list uint8 uint vertex_index\n"
                 "property uchar flags\nend_header\n0 0 0 12 0.5 255 0 51\n1 0 0 200 1e-50 255 0 51\n"
                 "1 1 0 7 -2 255 0 51\n0 1 0 0 3 255 0 51\n3 0 1 2 17\n3 0 2 3 4\n");
    EXPECT_THAT(mesh.vertexAttributes.at("age"), ElementsAre(12.f, 200.f, 7.f, 0.f));
    EXPECT_THAT(mesh.vertexAttributes.at("wetness"), ElementsAre(0.5f, 0.f, -2.f, 3.f));
    EXPECT_FLOAT_EQ(mesh.vertexAttributes.at("blue")[3], 0.2f);
    EXPECT_THAT(mesh.faceVertices, ElementsAre(0, 1, 2, 0, 2, 3));
}

TEST(MeshFile, plyJoinsTheVerticesThatUvSeamsSplit) {
    const Mesh mesh =
        readText("split.ply", "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
                              "property float z\nproperty float s\nproperty float t\nelement face 2\n"
                              "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n"
                              "1 0 0 0.5 0.5\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n3 3 4 5\n");
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.uvs.size(), 5u) << "one shared, one split";
    EXPECT_EQ(mesh.uvs[mesh.faceUvs[3]], V2f(0.5f, 0.5f));
}

TEST(MeshFile, plyStripsBecomeTriangles) {
    const Mesh mesh =
        readText("strips.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                               "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
                               "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n");
    EXPECT_THAT(mesh.faceVertices, ElementsAre(0, 1, 2, 2, 1, 3, 2, 3, 4, 0, 1, 2));
}

TEST(MeshFile, stlMergesVerticesInTextAndBinary) {
    for (const bool titledSolid : {false, true}) {
        const Mesh mesh = readText("b.stl", binaryStl(twoTriangles, titledSolid ? "solid but binary" : "x"));
        EXPECT_EQ(mesh.positions.size(), 4u);
        EXPECT_EQ(mesh.faceCount(), 2u);
    }
    const Mesh text =
        readText("a.stl", "solid thing\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
                          "   vertex 0 1 0\n  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n"
                          "   vertex 1 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n  endloop\n endfacet\n"
                          "endsolid thing\n");
    EXPECT_EQ(text.positions.size(), 4u);
    EXPECT_EQ(text.faceCount(), 2u);
}

TEST(MeshFile, offReadsPolygonsCommentsAndColours) {
    const Mesh mesh = readText("a.off", "OFF # made by hand\n\n5 2 0\n0 0 0\n1 0 0 # here\n1 1 0\n0 1 0\n0.5 2 0\n"
                                        "4 0 1 2 3 255 0 0\n3 3 2 4\n");
    EXPECT_THAT(mesh.faceSizes, ElementsAre(4, 3));
    EXPECT_EQ(
        readText("c.off", "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 9 9 9 9\n3 0 1 2\n").faceCount(),
        1u);
}

TEST(MeshFile, objWrittenReadsBackToTheSameBits) {
    Mesh mesh = makeSheet(3, 3);
    for (V3f& position : mesh.positions)
        position = position * 0.1234567f + V3f(1e-7f, -3e5f, 0.f);
    const TemporaryFile file("round.obj", "");
    writeObj(mesh, file.path());
    const Mesh back = readMesh(file.path());
    EXPECT_EQ(back.positions, mesh.positions);
    EXPECT_EQ(back.faceSizes, mesh.faceSizes);
    EXPECT_EQ(back.faceVertices, mesh.faceVertices);
    for (std::size_t i = 0; i < mesh.faceUvs.size(); ++i)
        EXPECT_EQ(back.uvs[back.faceUvs[i]], mesh.uvs[mesh.faceUvs[i]]);
}

TEST(MeshFile, plyWrittenKeepsSeamsAndAttributes) {
    Mesh cube = makeCube();
    cube.vertexAttributes["age"] = {0, 1, 2, 3, 4, 5, 6, 7};
    for (int face = 0; face < 6; ++face) // every face a chart of its own
        for (const V2f& uv : {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)}) {
            cube.faceUvs.push_back(static_cast<int>(cube.uvs.size()));
            cube.uvs.push_back(uv + V2f(static_cast<float>(face), 0));
        }
    const SurfaceMesh surface = makeLimitSurface(cube, {SubdivisionScheme::none, -1, 0});
    const TemporaryFile file("cube.ply", "");
    writePly(surface, file.path());
    const Mesh back = readMesh(file.path());
    EXPECT_EQ(back.positions.size(), 8u);
    EXPECT_EQ(back.uvs.size(), 24u);
    EXPECT_EQ(back.vertexAttributes.at("age"), cube.vertexAttributes["age"]);
    EXPECT_EQ(back.faceCount(), 12u);
}

TEST(MeshFile, outputsOfAFailedWriteLeaveNothingBehind) {
    EXPECT_THROW(writeObj(makeCube(), "/no/such/folder/cube.obj"), RunError);
}

TEST(MeshFile, sharedModelsHaveTheirKnownSizes) {
    const struct {
        const char* name;
        std::size_t vertices, faces;
        bool uvs;
    } models[] = {{"happy_buddha_60k_uv.obj", 30008, 60044, true},
                  {"igea_268k.ply", 134345, 268686, false},
                  {"spot_control_mesh.obj", 188, 180, true},
                  {"spot_quadrangulated.obj", 2930, 2928, true},
                  {"stanford_bunny_holes.obj", 34834, 69451, false}, // 35,947 less 1,113 unreferenced
                  {"suzanne.obj", 507, 500, false},
                  {"beetle_nonmanifold.obj", 1148, 2053, false},
                  {"teapot_open_patches.obj", 3644, 6320, false},
                  {"woody_flat_sheet.obj", 694, 1267, false},
                  {"rocker_arm_genus1.obj", 10044, 20088, false},
                  {"copper_strip_sheet.obj", 12545, 12288, true}};
    for (const auto& model : models) {
        PATINA_NEEDS_MODEL(model.name);
        const Mesh mesh = readMesh(sharedModel(model.name));
        EXPECT_EQ(mesh.positions.size(), model.vertices) << model.name;
        EXPECT_EQ(mesh.faceCount(), model.faces) << model.name;
        EXPECT_EQ(mesh.hasUvs(), model.uvs) << model.name;
        EXPECT_EQ(mesh.faceVertices.size(), mesh.hasUvs() ? mesh.faceUvs.size() : mesh.faceVertices.size());
    }
}

// --- what is wrong is said, with its place ---

TEST(MeshFileErrors, missingFilesFoldersAndUnknownFormats) {
    const TemporaryFile file("model.fbx", "whatever");
    EXPECT_THAT(errorOf(file.path()), HasSubstr("'fbx' cannot be read"));
    EXPECT_THAT(errorOf(file.path().parent_path() / "nothing.obj"), HasSubstr("no such file"));
    EXPECT_THAT(errorOf(file.path().parent_path()), HasSubstr("folder"));
    EXPECT_THAT(errorOf("plain", "v 0 0 0"), HasSubstr("no extension"));
    EXPECT_THAT(errorOf("model.objj", "v 0 0 0"), HasSubstr("did you mean 'obj'"));
}

TEST(MeshFileErrors, emptyFilesAndFilesWithoutFaces) {
    for (const char* name : {"a.obj", "a.ply", "a.stl", "a.off"})
        EXPECT_THAT(errorOf(name, ""), HasSubstr("empty"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("a.obj", "nothing to see here\n"), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("a.stl", binaryStl({})), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                                 "property float z\nend_header\n0 0 0\n"),
                HasSubstr("cloud of points"));
}

TEST(MeshFileErrors, nanAndInfinityNameTheVertex) {
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
                HasSubstr("a.obj:2: vertex 2 is not a number"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 -inf\nf 1 2 3\n"), HasSubstr("vertex 3 is infinite"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 1e300 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("vertex 2"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("'x' where a number should be"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("vertex 2 has too few numbers"));
    EXPECT_THAT(errorOf("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n"),
                HasSubstr("vertex 2 is not a number"));
    std::vector<V3f> corners = twoTriangles;
    corners[4].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(errorOf("a.stl", binaryStl(corners)), HasSubstr("triangle 2 is not a number"));
    EXPECT_THAT(errorOf("a.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"),
                HasSubstr("vertex 1 has a 'z' that is not a number"));
}

TEST(MeshFileErrors, indicesOutOfRangeNameTheFace) {
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n"),
                HasSubstr("a.obj:5: face 2 names vertex 4, but there are 3"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n"), HasSubstr("names vertex 0"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n"), HasSubstr("names vertex -4"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/9\n"),
                HasSubstr("texture coordinate 9, but there are 1"));
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n"), HasSubstr("not a corner"));
    EXPECT_THAT(errorOf("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), HasSubstr("face 0 names vertex 3"));
    EXPECT_THAT(errorOf("a.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
                HasSubstr("face 0 names vertex -1"));
}

TEST(MeshFileErrors, truncatedFilesSayWhereTheyEnd) {
    const std::string stl = binaryStl(twoTriangles);
    EXPECT_THAT(errorOf("a.stl", stl.substr(0, 140)), HasSubstr("ends after 1 of 2 triangles"));
    const SurfaceMesh cube = makeLimitSurface(makeCube(), {SubdivisionScheme::none, -1, 0});
    const TemporaryFile whole("cube.ply", "");
    writePly(cube, whole.path());
    std::ifstream stream(whole.path(), std::ios::binary);
    const std::string ply((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    ASSERT_GT(ply.size(), 400u);
    EXPECT_THAT(errorOf("cut.ply", ply.substr(0, ply.size() - 5)), HasSubstr("ends in face 11 of 12"));
    EXPECT_THAT(errorOf("cut.ply", ply.substr(0, ply.size() - 200)), HasSubstr("ends in vertex"));
    EXPECT_THAT(errorOf("cut.ply", ply.substr(0, 60)), HasSubstr("header"));
    EXPECT_THAT(errorOf("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), HasSubstr("ends where vertex 2 of 3 should be"));
    EXPECT_THAT(errorOf("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"), HasSubstr("endsolid"));
}

TEST(MeshFileErrors, countsThatNoFileCanHoldCostNothing) {
    EXPECT_THAT(errorOf("a.off", "OFF\n2000000000 2000000000 0\n0 0 0\n"), HasSubstr("do not fit"));
    EXPECT_THAT(errorOf("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
                                 "property float y\nproperty float z\nelement face 1\n"
                                 "property list uint uint vertex_indices\nend_header\n0000"),
                HasSubstr("more than can be counted"));
    EXPECT_THAT(errorOf("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\n"
                                 "property float y\nproperty float z\nelement face 1\n"
                                 "property list uint uint vertex_indices\nend_header\n0000"),
                HasSubstr("ends in vertex 0"));
}

TEST(MeshFileErrors, foreignFilesAreRecognised) {
    const std::string prose = "Once upon a time there was a statue that had stood by the sea for thirty years, and it "
                              "was green from head to foot but for the nose, which everybody touched.\n";
    EXPECT_THAT(errorOf("a.stl", prose), HasSubstr("not an STL file"));
    EXPECT_THAT(errorOf("a.ply", prose), HasSubstr("not a PLY file"));
    EXPECT_THAT(errorOf("a.off", prose), HasSubstr("not an OFF file"));
    EXPECT_THAT(errorOf("a.obj", binaryStl(twoTriangles)), HasSubstr("no faces"));
}

TEST(MeshFileErrors, modelsWithoutAreaAreRefused) {
    EXPECT_THAT(errorOf("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), HasSubstr("no area"));
    EXPECT_THAT(errorOf("a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), HasSubstr("one point"));
}

} // namespace
} // namespace patina
