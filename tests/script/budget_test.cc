// What `check` says a run will take, against what the volume then takes.

#include "script/budget.h"

#include "script/interpreter.h"
#include "support/test_surfaces.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

class BudgetTest : public testing::Test {
  protected:
    BudgetTest() {
        initializeVolumes();
        materials_ = MaterialLibrary::load(std::string(PATINA_SOURCE_DIR) + "/data");
        options_.scale = test::voxelScale();
        options_.longestSide = 40.0;
    }

    Program read(const std::string& text) {
        CheckContext context;
        declareAbilities(context, materials_);
        return readProgram(text, "test.patina", context);
    }

    void expectWithin15Percent(const char* what, const std::string& text, const SurfaceMesh& surface) {
        const Program program = read(text);
        const Budget budget = estimateBudget(program, surface, options_.scale, 64);
        Progress progress;
        const RunResult result = runProgram(program, surface, materials_, options_, progress);
        const LayerVolume& volume = *result.volume;
        const auto ratio = [](double said, double is) { return said / is; };
        EXPECT_NEAR(ratio(budget.activeVoxels, double(volume.activeVoxels())), 1.0, 0.15) << what;
        EXPECT_NEAR(ratio(budget.allocatedVoxels, 512.0 * double(volume.leafCount())), 1.0, 0.15) << what;
        EXPECT_NEAR(ratio(budget.volumeBytes, double(volume.memoryBytes())), 1.0, 0.1) << what;
        RecordProperty("voxels", std::to_string(budget.activeVoxels / double(volume.activeVoxels())));
        RecordProperty("bytes", std::to_string(budget.volumeBytes / double(volume.memoryBytes())));
    }

    MaterialLibrary materials_;
    RunOptions options_;
};

const char thin[] = "new copper\ncoat tarnish_1 0.1\ncoat cuprite_2 0.3\nerode 0.05\n";
const char thick[] = "new copper\ncoat tarnish_1 0.1\ncoat cuprite_2 2\ncoat soot 1.5\n";
const char intoTheMetal[] = "new copper\ncoat tarnish_1 0.1\nerode 2 facing(0, 0, 1) and metal\n";

TEST_F(BudgetTest, OfBallsIsWithin15PercentOfTheTruth) {
    expectWithin15Percent("small ball, thin", thin, test::sphere(20.f, 5));
    expectWithin15Percent("ball, thick", thick, test::sphere(33.f, 5));
    expectWithin15Percent("ball, into the metal", intoTheMetal, test::sphere(33.f, 5));
}

TEST_F(BudgetTest, OfATurnedSheetIsWithin15PercentOfTheTruth) {
    SurfaceMesh sheet = test::sheet(90.f, 60);
    for (auto* points : {&sheet.positions, &sheet.normals})
        for (Imath::V3f& p : *points)
            p = Imath::V3f(p.x, 0.8f * p.y - 0.6f * p.z, 0.6f * p.y + 0.8f * p.z);
    expectWithin15Percent("sheet", thin, sheet);
}

TEST_F(BudgetTest, CountsWhatTheHungriestOperatorNeeds) {
    // Thickness and slope of a thin shift, eight bytes; distance and foot, sixteen more, where it is thicker than a
    // voxel.
    const SurfaceMesh ball = test::sphere(33.f, 5);
    const auto working = [&](const std::string& statement) {
        const Budget with = estimateBudget(read("new copper\n" + statement), ball, options_.scale, 1);
        const Budget bare = estimateBudget(read("new copper\n"), ball, options_.scale, 1);
        return (with.peakBytes - with.volumeBytes - (bare.peakBytes - bare.volumeBytes)) / bare.activeVoxels;
    };
    EXPECT_NEAR(working("coat soot 0.2\n"), 8.0, 0.5);
    EXPECT_GT(working("coat soot 1.2\nerode 1.1\n"), 23.0);
}

} // namespace
} // namespace patina
