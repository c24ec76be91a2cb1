// A model that cannot be used ends with exit code 4, a place and a remedy, and no output folder.

#include "program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

namespace patina::test {

namespace {

using testing::HasSubstr;

// A binary STL of some triangles; `count` is what its head claims.
std::string binaryStl(const std::vector<std::array<float, 9>>& triangles, std::uint32_t count) {
    std::string bytes(80, ' ');
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    for (const auto& triangle : triangles) {
        const float normal[3] = {0.f, 0.f, 0.f};
        bytes.append(reinterpret_cast<const char*>(normal), sizeof normal);
        bytes.append(reinterpret_cast<const char*>(triangle.data()), sizeof triangle);
        bytes.append(2, '\0');
    }
    return bytes;
}

std::vector<std::array<float, 9>> cube(float side) {
    std::vector<std::array<float, 9>> triangles;
    for (int axis = 0; axis < 3; ++axis)
        for (int end = 0; end < 2; ++end) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            float corner[4][3];
            for (int i = 0; i < 4; ++i) {
                const int k = end ? i : 3 - i; // the other side the other way round
                corner[i][axis] = end ? side : 0.f;
                corner[i][u] = k == 1 || k == 2 ? side : 0.f;
                corner[i][v] = k >= 2 ? side : 0.f;
            }
            for (const int last : {2, 3}) {
                std::array<float, 9> t;
                std::memcpy(&t[0], corner[0], sizeof corner[0]);
                std::memcpy(&t[3], corner[last - 1], sizeof corner[0]);
                std::memcpy(&t[6], corner[last], sizeof corner[0]);
                triangles.push_back(t);
            }
        }
    return triangles;
}

class ModelErrors : public testing::Test {
  protected:
    ModelErrors() { folder.file("a.patina", "new copper\ncoat tarnish_1 0.35\n"); }

    Outcome run(const std::string& model, Arguments more = {}) const {
        Arguments words{"run", "a.patina", model, "-o", "out"};
        words.insert(words.end(), more.begin(), more.end());
        return vdbPatina(small(words), folder.path());
    }

    TemporaryFolder folder;
};

TEST_F(ModelErrors, EndWith4NameThePlaceAndLeaveNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    auto broken = cube(1.f);
    broken[5][4] = nan;
    struct {
        const char* file;
        std::string content;
        const char* place;
    } const models[] = {
        {"empty.obj", "", "empty.obj"},
        {"empty.stl", "", "empty.stl"},
        {"nothing.obj", "# no faces\nv 0 0 0\n", "nothing.obj"},
        {"truncated.stl", binaryStl(cube(1.f), 12).substr(0, 400), "truncated.stl"},
        {"truncated.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n",
         "truncated.ply"},
        {"claims.stl", binaryStl(cube(1.f), 4000000000u), "claims.stl"},
        {"nan.stl", binaryStl(broken, 12), "nan.stl"},
        {"nan.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", "nan.obj:2"},
        {"inf.obj", "v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n", "inf.obj:2"},
        {"range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "range.obj:4"},
        {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "zero.obj:4"},
        {"range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "range.off"},
        {"line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "line.obj"},
        {"point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "point.obj"},
        {"text.stl", "this is a letter and not a mesh\n" + std::string(200, 'x'), "text.stl"},
        {"text.ply", "dear reader\n", "text.ply"},
        {"page.obj", "<!DOCTYPE html><html><body>404</body></html>\n", "page.obj"},
        {"scene.fbx", "Kaydara FBX Binary", "scene.fbx"},
        {"uv.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 3 0\nvt 0 1\nf 1/1 2/2 3/3\n", "uv.obj: face 1"},
    };
    std::vector<Arguments> lines;
    for (const auto& model : models) {
        folder.file(model.file, model.content);
        lines.push_back(small({"run", "a.patina", model.file, "-o", "out"}));
    }
    const std::vector<Outcome> outcomes = vdbPatinaEach(lines, folder.path());
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const auto& model = models[i];
        const Outcome& outcome = outcomes[i];
        SCOPED_TRACE(model.file);
        EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_THAT(outcome.err, HasSubstr(std::string("error: ") + model.place));
        EXPECT_THAT(outcome.err, testing::EndsWith(")\n")) << "the remedy stands in brackets";
    }
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(ModelErrors, AModelThatIsNoneIsToldFromAShapeMisspelt) {
    const std::pair<const char*, const char*> models[] = {{"statuete", "did you mean 'statuette'?"},
                                                          {"elephant", "shapes are plate, strip"},
                                                          {"nosuch.obj", "error: nosuch.obj: there is no such file"},
                                                          {".", "this is a folder"}};
    for (const auto& [model, says] : models) {
        const Outcome outcome = run(model);
        EXPECT_EQ(outcome.exitCode, 4) << model;
        EXPECT_THAT(outcome.err, HasSubstr(says));
    }
}

TEST_F(ModelErrors, AVoxelLargerThanTheModelIsAWrongCommandLine) {
    const Outcome outcome = vdbPatina({"run", "a.patina", "strip", "--voxel-size", "5", "-o", "out"}, folder.path());
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_THAT(outcome.err, HasSubstr("error: --voxel-size: the model's longest side of 0.3 scene units"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST_F(ModelErrors, NoneForACubeInStl) {
    folder.file("cube.stl", binaryStl(cube(0.1f), 12));
    const Outcome outcome = run("cube.stl");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("10 cm × 10 cm × 10 cm"));
    EXPECT_THAT(outcome.err, HasSubstr("closed"));
}

TEST_F(ModelErrors, NoneForUvsThatStickOutByATexel) {
    folder.file("uv.obj",
                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1.001 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    const Outcome outcome = run("uv.obj");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: UVs reach 0.001 beyond the unit square"));
    EXPECT_THAT(readFile(folder.path() / "out/a.obj"), testing::Not(HasSubstr("1.001")));
}

TEST_F(ModelErrors, NoneForUvsAnywhereWithAnAtlas) {
    folder.file("uv.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 3 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    EXPECT_EQ(run("uv.obj", {"--atlas"}).exitCode, 0);
}

} // namespace

} // namespace patina::test
