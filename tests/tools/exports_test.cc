// What other programs are given by option: fog, half fields, the displaced mesh, vectors in their own space, up.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::test {

namespace {

using testing::HasSubstr;

class Exports : public testing::Test {
  protected:
    Outcome run(const Arguments& words) const { return vdbPatina(words, folder.path()); }
    TemporaryFolder folder;
};

TEST_F(Exports, FogMicroMeshAndVectorsAreWrittenWhereAskedFor) {
    folder.file("film.patina", "new copper\ncoat cuprite_2 1um exposure\n");
    const Outcome outcome =
        run(small({"run", "film.patina", "sphere", "--fog", "--half-fields", "--micro-mesh", "--vector-displacement",
                   "--vector-space", "blender", "--exaggeration", "2000"}));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto made = filesIn(folder.path() / "film");
    for (const char* name : {"film_fog.vdb", "film_micro.ply", "vector_displacement.exr"})
        EXPECT_EQ(made.count(name), 1u) << name;
    const std::string ply = readFile(folder.path() / "film" / "film_micro.ply");
    for (const char* property :
         {"uchar red", "float material_id", "float thickness_01_cuprite_2", "float nx", "float s"})
        EXPECT_THAT(ply.substr(0, 800), HasSubstr(std::string("property ") + property + "\n"));
    EXPECT_THAT(readFile(folder.path() / "film" / "vector_displacement.exr").substr(0, 4000), HasSubstr("blender"));
    const std::string report = readFile(folder.path() / "film" / "report.json");
    EXPECT_THAT(report, HasSubstr("film_fog.vdb"));
    EXPECT_THAT(report, HasSubstr("film_micro.ply"));
    EXPECT_EQ(run({"run", "film.patina", "sphere", "--vector-space", "tangent"}).exitCode, 2);
}

// A volume made with --up z is baked as such without saying so again; who says otherwise is heard.
TEST_F(Exports, TheVolumeKnowsWhichWayIsUp) {
    folder.file("film.patina", "new copper\ncoat cuprite_2 1um\n");
    ASSERT_EQ(run(small({"run", "film.patina", "sphere", "--up", "z"})).exitCode, 0);
    EXPECT_THAT(readFile(folder.path() / "film" / "film.usda"), HasSubstr("upAxis = \"Z\""));
    ASSERT_EQ(run({"bake", "film/film.vdb", "film/film.obj", "-o", "again", "--resolution", "64"}).exitCode, 0);
    EXPECT_THAT(readFile(folder.path() / "again" / "film.usda"), HasSubstr("upAxis = \"Z\""));
    ASSERT_EQ(run({"bake", "film/film.vdb", "film/film.obj", "-o", "y", "--resolution", "64", "--up", "y"}).exitCode,
              0);
    EXPECT_THAT(readFile(folder.path() / "y" / "film.usda"), HasSubstr("upAxis = \"Y\""));
}

// NAME.obj is the model once more: creases come through, and the same volume is baked from it.
TEST_F(Exports, CreasesComeThroughToObjAndUsd) {
    folder.file("film.patina", "new copper\ncoat cuprite_2 1um\n");
    folder.file("cube.obj",
                "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
                "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nt crease 2/1/0 4 5 2.5\n");
    const Outcome outcome = run(small({"run", "film.patina", "cube.obj"}));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(readFile(folder.path() / "film" / "film.obj"), HasSubstr("t crease 2/1/0 4 5 2.5\n"));
    EXPECT_THAT(readFile(folder.path() / "film" / "film.usda"), HasSubstr("creaseSharpnesses = [2.5]"));
    const Outcome baked = run({"bake", "film/film.vdb", "film/film.obj", "-o", "again", "--resolution", "64"});
    EXPECT_EQ(baked.exitCode, 0) << baked.err;
}

// The normals that a scan is displaced along stand in NAME.obj; a cage has those of its limit surface instead.
TEST_F(Exports, ScansHaveTheirNormalsInTheObj) {
    folder.file("film.patina", "new copper\ncoat cuprite_2 1um\n");
    ASSERT_EQ(run(small({"run", "film.patina", "sphere", "--scheme", "none"})).exitCode, 0);
    EXPECT_THAT(readFile(folder.path() / "film" / "film.obj"), HasSubstr("\nvn "));
    ASSERT_EQ(run(small({"run", "film.patina", "sphere", "-o", "cage"})).exitCode, 0);
    EXPECT_THAT(readFile(folder.path() / "cage" / "film.obj"), testing::Not(HasSubstr("\nvn ")));
    const Outcome baked =
        run({"bake", "film/film.vdb", "film/film.obj", "-o", "again", "--resolution", "64", "--scheme", "none"});
    EXPECT_EQ(baked.exitCode, 0) << baked.err;
}

} // namespace

} // namespace patina::test
