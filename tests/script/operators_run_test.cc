// Scripts with every operator, run from their text to the volume.

#include "script/interpreter.h"

#include "script/budget.h"
#include "support/test_surfaces.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// A body of 40 voxels across, a voxel being a micrometre.
class OperatorsRunTest : public testing::Test {
  protected:
    OperatorsRunTest() {
        initializeVolumes();
        materials_ = MaterialLibrary::load(std::string(PATINA_SOURCE_DIR) + "/data");
        options_.scale = test::voxelScale();
        options_.longestSide = 40.0;
    }

    RunResult run(const std::string& text, const SurfaceMesh& surface) {
        CheckContext context;
        declareAbilities(context, materials_);
        program_ = readProgram(text, "test.patina", context);
        return runProgram(program_, surface, materials_, options_, progress_);
    }
    StackStatistics stackOf(const RunResult& result, const SurfaceMesh& surface) {
        return measureStack(*result.volume, surface);
    }

    MaterialLibrary materials_;
    RunOptions options_;
    Progress progress_;
    Program program_;
    const SurfaceMesh ball_ = test::sphere(20.f, 5);
};

TEST_F(OperatorsRunTest, EveryStatementDoesWhatItSays) {
    const RunResult result = run("new copper\n"
                                 "coat tarnish_1 0.4\n"
                                 "coat posnjakite 0.5\n"
                                 "grow tarnish_1 0.2\n"
                                 "convert posnjakite to brochantite 0.6\n"
                                 "polish 1.0\n"
                                 "fill dirt 1.3\n"
                                 "erode 0.1\n",
                                 ball_);
    ASSERT_EQ(result.volume->layers(), (std::vector<std::string>{"tarnish_1", "posnjakite", "brochantite", "dirt"}));
    const StackStatistics stack = stackOf(result, ball_);
    EXPECT_NEAR(stack.layers[0].meanUm, 0.6, 0.01);
    EXPECT_NEAR(stack.layers[1].meanUm, 0.2, 0.01);
    EXPECT_NEAR(stack.layers[2].meanUm, 0.2, 0.01);
    EXPECT_NEAR(stack.layers[3].meanUm, 0.2, 0.01);
}

TEST_F(OperatorsRunTest, MapsThatAskWhereUpIsSayWhereTheyStand) {
    options_.up = Imath::V3d(0.0);
    for (const char* map : {"slope", "elevation", "exposure", "wetness"})
        try {
            run(std::string("new copper\ncoat soot 0.2 0.5 * ") + map + "\n", ball_);
            ADD_FAILURE() << map << " had an up axis";
        } catch (const RunError& error) {
            EXPECT_NE(std::string(error.what()).find("test.patina:2:21"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("no up axis"), std::string::npos) << error.what();
        }
}

TEST_F(OperatorsRunTest, ErodeAndMetalGoesBelowTheBase) {
    const RunResult result = run("new copper\ncoat soot 0.2\nerode 0.7 and metal\n", ball_);
    EXPECT_EQ(result.volume->layerCount(), 0);
    EXPECT_NEAR(stackOf(result, ball_).metalLoss.meanUm, 0.5, 0.01);
}

TEST_F(OperatorsRunTest, PolishAreaAndFillAboveSmoothAndOffsetRun) {
    const RunResult result = run("new copper\n"
                                 "coat soot 1 texture(RD(rate=linear, step=4, total=4, cell=3um))\n"
                                 "polish area 0.4\n"
                                 "fill dirt 0.2 above smooth(3um)\n"
                                 "offset wax 3um\n"
                                 "polish area 0.3 slope window 8um\n"
                                 "polish area 0.1 of soot\n",
                                 ball_);
    EXPECT_EQ(result.finished, 7u);
    EXPECT_NEAR(result.statements[2].operation.fraction.value_or(0.0), 0.4, 1e-3);
}

TEST_F(OperatorsRunTest, OffsetByTangentSphereCoatsWhereTheSphereIsSmaller) {
    // The inside of a bowl of radius 20: spheres of 20 touch it, none larger.
    SurfaceMesh bowl = test::sheet(30.f, 60);
    for (std::size_t v = 0; v < bowl.positions.size(); ++v) {
        Imath::V3f& p = bowl.positions[v];
        const Imath::V3f out(p.x - 15.f, p.y - 15.f, 0.f);
        const float z = -std::sqrt(std::max(20.f * 20.f - out.dot(out), 1.f));
        p.z = 20.f + z;
        bowl.normals[v] = Imath::V3f(-out.x, -out.y, -z).normalized();
    }
    options_.longestSide = 30.0;
    const auto meanIn = [&](const std::string& offset) {
        const RunResult result = run("new copper\n" + offset + "\n", bowl);
        const StackProbe probe(*result.volume);
        std::vector<double> um(1, 0.0);
        double sum = 0.0, count = 0.0;
        for (std::size_t v = 0; v < bowl.positions.size(); ++v) {
            const Imath::V3f& p = bowl.positions[v];
            if (std::hypot(p.x - 15.f, p.y - 15.f) > 10.f)
                continue; // the edge
            probe.read(Imath::V3d(p), Imath::V3d(bowl.normals[v]), um.data());
            sum += um[0];
            count += 1.0;
        }
        return sum / count;
    };
    EXPECT_NEAR(meanIn("offset wax 23um tangent-sphere 0.5"), 0.5, 0.01);
    EXPECT_NEAR(meanIn("offset wax 17um tangent-sphere 0.5"), 0.0, 0.01);
    EXPECT_NEAR(meanIn("offset wax 23um tangent-sphere 0.5 global"), 0.5, 0.01);
}

TEST_F(OperatorsRunTest, TheBandHoldsWhatTheScriptPilesUp) {
    const RunResult result = run("new copper\ncoat soot 1\nfill dirt 6\ngrow soot 2\ncoat wax 1\n", ball_);
    for (const StatementReport& statement : result.statements)
        EXPECT_FALSE(statement.operation.grewBand) << statement.text;
    EXPECT_NEAR(thickestStackVoxels(program_, options_.scale), 9.0, 1e-9);
    EXPECT_NEAR(stackOf(result, ball_).total.meanUm, 9.0, 0.1);
    const RunResult deep = run("new copper\nerode 6 and metal\n", ball_);
    EXPECT_FALSE(deep.statements[1].operation.grewBand);
}

} // namespace
} // namespace patina
