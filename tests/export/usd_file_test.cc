#include "export/usd_file.h"

#include "base/errors.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// Two quads, joined along an edge in space and apart in the UVs.
Mesh twoQuads() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0.1f}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0.1f}};
    mesh.faceSizes = {4, 4};
    mesh.faceVertices = {0, 1, 4, 3, 1, 2, 5, 4};
    mesh.uvs = {{0, 0}, {0.4f, 0}, {0.4f, 1}, {0, 1}, {0.6f, 0}, {1, 0}, {1, 1}, {0.6f, 1}};
    mesh.faceUvs = {0, 1, 2, 3, 4, 5, 6, 7};
    return mesh;
}

class UsdFileTest : public testing::Test {
  protected:
    UsdFileTest() {
        scene_.name = "marine";
        scene_.mesh = &mesh_;
        scene_.scheme = "catmullClark";
        scene_.maps.baked = true;
        scene_.maps.maxDisplacement = 0.25f;
        scene_.volumeFile = "marine.vdb";
        scene_.fields = {{"base", false, true}, {"material", true, false}, {"exposure", false, false}};
    }
    Mesh mesh_ = twoQuads();
    UsdScene scene_;
};

TEST_F(UsdFileTest, TheStageSaysUnitUpAxisAndDefaultPrim) {
    scene_.metresPerUnit = 0.01;
    scene_.zUp = true;
    const std::string text = usdText(scene_);
    EXPECT_EQ(text.rfind("#usda 1.0\n", 0), 0u);
    EXPECT_THAT(text, HasSubstr("metersPerUnit = 0.01\n"));
    EXPECT_THAT(text, HasSubstr("upAxis = \"Z\"\n"));
    EXPECT_THAT(text, HasSubstr("defaultPrim = \"marine\"\n"));
    EXPECT_THAT(text, HasSubstr("def Xform \"marine\""));
}

TEST_F(UsdFileTest, MeshesKeepCreasesAndSharpCornersWhereTheyAreSubdivided) {
    EXPECT_THAT(usdText(scene_), Not(HasSubstr("crease")));
    mesh_.creases = {{1, 4, 2.5f}, {0, 1, 10.f}};
    mesh_.corners = {{3, 4.f}};
    const std::string text = usdText(scene_);
    EXPECT_THAT(text, HasSubstr("int[] creaseIndices = [1, 4, 0, 1]\n"));
    EXPECT_THAT(text, HasSubstr("int[] creaseLengths = [2, 2]\n"));
    EXPECT_THAT(text, HasSubstr("float[] creaseSharpnesses = [2.5, 10]\n"));
    EXPECT_THAT(text, HasSubstr("int[] cornerIndices = [3]\n"));
    EXPECT_THAT(text, HasSubstr("float[] cornerSharpnesses = [4]\n"));
    scene_.scheme = "none";
    EXPECT_THAT(usdText(scene_), Not(HasSubstr("crease")));
}

TEST_F(UsdFileTest, MeshesKeepFacesSchemeAndUvsPerCorner) {
    const std::string text = usdText(scene_);
    EXPECT_THAT(text, HasSubstr("subdivisionScheme = \"catmullClark\""));
    EXPECT_THAT(text, HasSubstr("faceVaryingLinearInterpolation = \"boundaries\""));
    EXPECT_THAT(text, HasSubstr("faceVertexCounts = [4, 4]\n"));
    EXPECT_THAT(text, HasSubstr("faceVertexIndices = [0, 1, 4, 3, 1, 2, 5, 4]\n"));
    EXPECT_THAT(text, HasSubstr("(2, 1, 0.1)]"));
    EXPECT_THAT(text, HasSubstr("texCoord2f[] primvars:st = [(0, 0), (0.4, 0)"));
    EXPECT_THAT(text, HasSubstr("interpolation = \"faceVarying\""));
    EXPECT_THAT(text, HasSubstr("primvars:st:indices = [0, 1, 2, 3, 4, 5, 6, 7]\n"));
    EXPECT_THAT(text, Not(HasSubstr("normals")));
}

TEST_F(UsdFileTest, MeshesThatAreNotSubdividedHaveTheNormalsOfTheBake) {
    scene_.scheme = "none";
    std::vector<Imath::V3f> normals(6, Imath::V3f(0, 0, 1));
    scene_.normals = &normals;
    const std::string text = usdText(scene_);
    EXPECT_THAT(text, HasSubstr("normal3f[] normals = [(0, 0, 1), (0, 0, 1)"));
    EXPECT_THAT(text, Not(HasSubstr("faceVaryingLinearInterpolation")));
    normals.pop_back();
    EXPECT_THROW(usdText(scene_), RunError);
}

TEST_F(UsdFileTest, MaterialsReadTheMapsBesideThem) {
    const std::string text = usdText(scene_);
    for (const char* map : {"base_color", "metallic", "roughness", "displacement", "normal"})
        EXPECT_THAT(text, HasSubstr(std::string("@./") + map + ".exr@")) << map;
    EXPECT_THAT(text, HasSubstr("rel material:binding = </marine/Materials/Patina>"));
    EXPECT_THAT(text, HasSubstr("colorSpace = \"lin_rec709\""));
    EXPECT_THAT(text, Not(HasSubstr("@/"))); // no absolute path
    EXPECT_THAT(text, HasSubstr("disp_padding = 0.25"));
    scene_.maps.colourSpace = ColourSpace::acescg;
    EXPECT_THAT(usdText(scene_), HasSubstr("colorSpace = \"acescg\""));
    scene_.maps.baked = false;
    EXPECT_THAT(usdText(scene_), Not(HasSubstr("Material")));
}

TEST_F(UsdFileTest, TheVolumeNamesItsGrids) {
    const std::string text = usdText(scene_);
    EXPECT_THAT(text, HasSubstr("rel field:material = </marine/Volume/material>"));
    EXPECT_THAT(text, HasSubstr("def OpenVDBAsset \"base\""));
    EXPECT_THAT(text, HasSubstr("asset filePath = @./marine.vdb@"));
    EXPECT_THAT(text, HasSubstr("token fieldName = \"exposure\""));
    EXPECT_THAT(text, HasSubstr("token fieldDataType = \"int\""));
    EXPECT_THAT(text, HasSubstr("token fieldClass = \"levelSet\""));
    EXPECT_THAT(text, Not(HasSubstr("xformOp")));
    scene_.volumeUnitsPerUnit = 1024.0;
    EXPECT_THAT(usdText(scene_), HasSubstr("float3 xformOp:scale = (0.0009765625, 0.0009765625, 0.0009765625)"));
}

TEST_F(UsdFileTest, NamesThatUsdDoesNotTakeAreReplaced) {
    scene_.name = "3 years@sea";
    scene_.volumeFile = "3 years@sea.vdb";
    const std::string text = usdText(scene_);
    EXPECT_THAT(text, HasSubstr("defaultPrim = \"_3_years_sea\""));
    EXPECT_THAT(text, HasSubstr("@@@./3 years@sea.vdb@@@"));
}

TEST_F(UsdFileTest, NothingHalfWrittenIsLeft) {
    test::TemporaryFolder folder;
    EXPECT_THROW(writeUsd(scene_, folder / "no" / "marine.usda"), RunError);
    writeUsd(scene_, folder / "marine.usda");
    scene_.mesh = nullptr;
    EXPECT_THROW(writeUsd(scene_, folder / "marine.usda"), RunError);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "."), fs::directory_iterator()), 1);
    EXPECT_GT(fs::file_size(folder / "marine.usda"), 1000u);
}

} // namespace
} // namespace patina
