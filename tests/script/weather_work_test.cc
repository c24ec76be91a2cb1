// A second frame does the work of the years it adds: counted in voxelisations, rays' gatherings and particles, not in
// seconds.

#include "script/interpreter.h"
#include "script/weather_script.h"

#include "base/atomic_file.h"
#include "support/temporary_folder.h"
#include "support/test_surfaces.h"
#include "volume/vdb_file.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace patina {
namespace {

/// Counts what is reported while fields are gathered: fifty times for each dome.
class CountingProgress : public Progress {
  public:
    void update(double) override { ++updates; }
    int updates = 0;
};

struct Work {
    int gatherings = 0;
    std::uint64_t arrivals = 0; ///< of particles, in all patterns
    bool voxelised = false;
};

class WeatherWork : public testing::Test {
  protected:
    WeatherWork() {
        initializeVolumes();
        materials_ = MaterialLibrary::load(dataFolder_);
        declareAbilities(context_, materials_);
        options_.scale.metresPerUnit = 1e-3;
        options_.scale.voxelSize = 2.0;
        options_.longestSide = 60.0;
    }

    /// The work of each frame of one series.
    std::vector<Work> run(const std::vector<double>& years) {
        const test::TemporaryFolder folder;
        RunSession session;
        RunOptions options = options_;
        options.session = &session;
        std::vector<Work> all;
        const WeatherPlan plan = readWeatherPlan(dataFolder_, "marine", "copper");
        for (const WeatherFrame& frame : weatherScripts(plan, {}, years, "marine")) {
            std::filesystem::create_directories(folder / frame.folder);
            const std::filesystem::path base = folder / frame.folder / "marine";
            writeTextFile(base.string() + ".patina", frame.script);
            const Program program = readProgramFile(base.string() + ".patina", context_);
            CountingProgress progress;
            RunResult result = runProgram(program, body_, materials_, options, progress);
            Work work;
            work.gatherings = progress.updates;
            work.voxelised = result.voxelizeSeconds > 0.0;
            for (const StatementReport& statement : result.statements)
                for (const GrowthStatistics& growth : statement.growths)
                    work.arrivals += growth.arrivals;
            all.push_back(work);
            writeVolume(*result.volume, base.string() + ".vdb");
            session.keep(base.string() + ".vdb", std::move(*result.volume));
        }
        return all;
    }

    const std::filesystem::path dataFolder_ = std::filesystem::path(PATINA_SOURCE_DIR) / "data";
    const SurfaceMesh body_ = test::sphere(30.f, 4);
    MaterialLibrary materials_;
    CheckContext context_;
    RunOptions options_;
};

TEST_F(WeatherWork, OfASecondFrameIsThatOfTheYearsItAdds) {
    const std::vector<Work> one = run({0.0, 30.0}), two = run({0.0, 12.0, 30.0});
    ASSERT_EQ(one.size(), 2u);
    ASSERT_EQ(two.size(), 3u);
    EXPECT_TRUE(two[0].voxelised);
    EXPECT_FALSE(two[1].voxelised || two[2].voxelised);
    // Fields of a thin stack are those of the metal: gathered once, for whatever years follow.
    EXPECT_GT(one[1].gatherings, 0);
    EXPECT_EQ(two[1].gatherings, one[1].gatherings);
    EXPECT_EQ(two[2].gatherings, 0);
    // Patterns go on where they were.
    EXPECT_GT(one[1].arrivals, 0u);
    EXPECT_LT(two[2].arrivals, one[1].arrivals);
    EXPECT_LT(two[1].arrivals + two[2].arrivals, 1.01 * one[1].arrivals);
}

} // namespace
} // namespace patina
