// The paper's statue and towers (data/scripts), run from their text on a small body: does patina lie where the paper's
// words put it?

#include "script/interpreter.h"

#include "base/atomic_file.h"
#include "support/temporary_folder.h"
#include "volume/layer_volume.h"
#include "volume/stack_probe.h"
#include "volume/vdb_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace patina {
namespace {

constexpr double side = 60.0, depth = 40.0, bottom = 28.5, top = 31.5, floorOfGroove = 31.0;

/// A rectangle in squares of about a millimetre, facing u × v.
void addRectangle(SurfaceMesh& mesh, const Imath::V3d& corner, const Imath::V3d& u, const Imath::V3d& v) {
    const int m = std::max(1, int(std::lround(u.length()))), n = std::max(1, int(std::lround(v.length())));
    const int first = int(mesh.positions.size());
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= m; ++i) {
            mesh.positions.emplace_back(corner + u * (double(i) / m) + v * (double(j) / n));
            mesh.normals.emplace_back(u.cross(v).normalized());
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < m; ++i) {
            const int a = first + j * (m + 1) + i;
            mesh.triangles.emplace_back(a, a + 1, a + m + 2);
            mesh.triangles.emplace_back(a, a + m + 2, a + m + 1);
        }
}

/// A block of 60 × 60 × 40 mm on the ground, y up, with a horizontal groove, 3 mm wide and 9 mm deep, at half the
/// height of its south side (+z): narrower than a finger, and under a roof.
SurfaceMesh grooved() {
    SurfaceMesh mesh;
    const Imath::V3d x(side, 0, 0);
    const auto along = [&](const Imath::V3d& from, const Imath::V3d& way) { addRectangle(mesh, from, x, way); };
    along({0, 0, depth}, {0, bottom, 0}); // the south side, up
    along({0, bottom, depth}, {0, 0, floorOfGroove - depth});
    along({0, bottom, floorOfGroove}, {0, top - bottom, 0});
    along({0, top, floorOfGroove}, {0, 0, depth - floorOfGroove});
    along({0, top, depth}, {0, side - top, 0});
    along({0, side, depth}, {0, 0, -depth}); // over the top, down the north side and back
    along({0, side, 0}, {0, -side, 0});
    along({0, 0, 0}, {0, 0, depth});
    const double heights[4] = {0.0, bottom, top, side};
    for (int i = 0; i < 3; ++i) { // the ends
        const Imath::V3d up(0, heights[i + 1] - heights[i], 0), south(0, 0, i == 1 ? floorOfGroove : depth);
        addRectangle(mesh, {0, heights[i], 0}, south, up);
        addRectangle(mesh, {side, heights[i], 0}, up, south);
    }
    mesh.triangleFaces.resize(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangleFaces.size(); ++i)
        mesh.triangleFaces[i] = int(i);
    return mesh;
}

bool inGroove(const Imath::V3d& p, const Imath::V3d& n) {
    return p.y > bottom + 0.5 && p.y < top - 0.5 && n.z > 0.5;
}
bool onSouthSide(const Imath::V3d& p, const Imath::V3d& n) {
    return n.z > 0.5 && p.z > depth - 0.5 && p.x > 8 && p.x < 52;
}

class Presets : public testing::Test {
  protected:
    Presets() {
        initializeVolumes();
        materials_ = MaterialLibrary::load(std::string(PATINA_SOURCE_DIR) + "/data");
        options_.scale.metresPerUnit = 1e-3;
        options_.scale.voxelSize = 1.0;
        options_.longestSide = 60.0;
    }

    RunResult run(const std::string& name, const std::map<std::string, std::string>& settings) {
        CheckContext context;
        declareAbilities(context, materials_);
        context.settings = settings;
        program_ = readProgramFile(std::string(PATINA_SOURCE_DIR) + "/data/scripts/" + name, context);
        EXPECT_TRUE(program_.warnings.empty()) << name;
        return runProgram(program_, body_, materials_, options_, progress_);
    }

    /// Thicknesses of a material, µm, at what `counts` of the surface, ascending.
    std::vector<double> sortedUm(const RunResult& result, const std::string& material,
                                 const std::function<bool(const Imath::V3d&, const Imath::V3d&)>& counts) {
        std::vector<double> all;
        meanUm(result, material, counts, &all);
        std::sort(all.begin(), all.end());
        return all;
    }

    /// Mean thickness of a material, µm, over what `counts` of the surface, by place and normal.
    double meanUm(const RunResult& result, const std::string& material,
                  const std::function<bool(const Imath::V3d&, const Imath::V3d&)>& counts,
                  std::vector<double>* all = nullptr) {
        const auto& layers = result.volume->layers();
        const auto found = std::find(layers.begin(), layers.end(), material);
        if (found == layers.end())
            return 0.0;
        const StackProbe probe(*result.volume);
        std::vector<double> um(layers.size());
        double sum = 0.0, count = 0.0;
        for (const Imath::V3i& t : body_.triangles) {
            const Imath::V3d a(body_.positions[t.x]), b(body_.positions[t.y]), c(body_.positions[t.z]);
            const Imath::V3d middle = (a + b + c) / 3.0, normal = (b - a).cross(c - a).normalized();
            if (!counts(middle, normal))
                continue;
            probe.read(middle, normal, um.data());
            sum += um[std::size_t(found - layers.begin())];
            count += 1.0;
            if (all)
                all->push_back(um[std::size_t(found - layers.begin())]);
        }
        EXPECT_GT(count, 0.0);
        return sum / count;
    }

    const SurfaceMesh body_ = grooved();
    MaterialLibrary materials_;
    RunOptions options_;
    Progress progress_;
    Program program_;
};

// `open` in place of `new`, and the year it was left in: one history, whatever the stops on its way (figure 11).
TEST_F(Presets, TheBuddhaGoesOnFromAnEarlierYear) {
    const RunResult direct = run("buddha.patina", {{"year", "15"}});
    const RunResult early = run("buddha.patina", {{"year", "6"}});
    const test::TemporaryFolder folder;
    writeVolume(*early.volume, folder / "early.vdb");
    std::string script = readTextFile(std::string(PATINA_SOURCE_DIR) + "/data/scripts/buddha.patina");
    const std::string beginning = "\nnew copper\n";
    ASSERT_NE(script.find(beginning), std::string::npos);
    script.replace(script.find(beginning), beginning.size(), "\nopen \"early.vdb\"\n");
    writeTextFile(folder / "later.patina", script);
    CheckContext context;
    declareAbilities(context, materials_);
    context.settings = {{"since", "6"}, {"year", "15"}};
    const Program later = readProgramFile(folder / "later.patina", context);
    const RunResult result = runProgram(later, body_, materials_, options_, progress_);
    ASSERT_EQ(result.volume->layers(), direct.volume->layers());
    const auto all = [](const Imath::V3d&, const Imath::V3d&) { return true; };
    for (const std::string& layer : direct.volume->layers())
        EXPECT_NEAR(meanUm(result, layer, all), meanUm(direct, layer, all), 1e-6) << layer;
    EXPECT_LT(meanUm(early, "brochantite", all), 0.5 * meanUm(direct, "brochantite", all));
}

TEST_F(Presets, TheBuddhaIsDarkWhereNoHandReachesAndGreenWhereWaterStands) {
    const RunResult bare = run("buddha.patina", {{"year", "0"}});
    const auto all = [](const Imath::V3d&, const Imath::V3d&) { return true; };
    EXPECT_NEAR(meanUm(bare, "tarnish_1", all), 0.0, 1e-3);

    const RunResult old = run("buddha.patina", {{"year", "30"}});
    const auto reached = [](const Imath::V3d& p, const Imath::V3d& n) {
        return onSouthSide(p, n) && p.y > 40 && p.y < 55;
    };
    const auto foot = [](const Imath::V3d& p, const Imath::V3d& n) { return onSouthSide(p, n) && p.y < 6; };
    const auto roof = [](const Imath::V3d& p, const Imath::V3d& n) {
        return n.y > 0.5 && p.y > 59 && p.x > 8 && p.x < 52;
    };
    // "tarnish ... polished away where a hand reaches, darker in the creases" (section 5.2)
    EXPECT_GT(meanUm(old, "tarnish_1", inGroove), 0.9);
    EXPECT_LT(meanUm(old, "tarnish_1", reached), 0.15);
    // "the base ... where water is likely to accumulate"; horizontal places patinate more than vertical ones (2.2)
    EXPECT_GT(meanUm(old, "brochantite", foot), 2.0 * meanUm(old, "brochantite", reached));
    EXPECT_GT(meanUm(old, "brochantite", roof), meanUm(old, "brochantite", reached));
    // "Steadily growing random patches": on the north side, where neither hand nor foot makes a difference, the tenth
    // with the most has half as much again as the tenth with the least and more.
    const auto north = [](const Imath::V3d& p, const Imath::V3d& n) {
        return n.z < -0.5 && p.y > 22 && p.y < 52 && p.x > 8 && p.x < 52;
    };
    const std::vector<double> side = sortedUm(old, "brochantite", north);
    EXPECT_GT(side[side.size() * 9 / 10], 1.6 * side[side.size() / 10]); // hands keep them thin here
    EXPECT_GT(side[side.size() / 10], 0.3); // on the steadily thickening layer
    const RunResult young = run("buddha.patina", {{"year", "9"}});
    EXPECT_LT(meanUm(young, "brochantite", reached), 0.5 * meanUm(old, "brochantite", reached));
}

TEST_F(Presets, TheOldTowerIsGreenAllOverWithDirtWhereNoRainWashes) {
    const RunResult old = run("tower_old.patina", {});
    const auto north = [](const Imath::V3d& p, const Imath::V3d& n) {
        return n.z < -0.5 && p.y > 10 && p.x > 8 && p.x < 52;
    };
    const auto south = [](const Imath::V3d& p, const Imath::V3d& n) { return onSouthSide(p, n) && p.y > 35; };
    EXPECT_GT(meanUm(old, "patina_urban_4", south), 2.0);
    EXPECT_GT(meanUm(old, "patina_urban_4", north),
              1.3 * meanUm(old, "patina_urban_4", south)); // "steep and sunny: thinner"
    EXPECT_GT(meanUm(old, "dirt", inGroove), 2.0 * meanUm(old, "dirt", south));
}

TEST_F(Presets, TheYoungTowerIsBrownWithStainsThatRunDown) {
    // As tall as a small tower, so that the script's noise has room: three metres.
    options_.scale.metresPerUnit = 0.05;
    const RunResult young = run("tower_young.patina", {});
    // "Staining due to the flow of water over the top of the tower": streaks under the top, none at the foot.
    const auto high = [](const Imath::V3d& p, const Imath::V3d& n) {
        return std::abs(n.z) > 0.5 && p.y > 46 && p.y < 57 && p.x > 4 && p.x < 56;
    };
    const auto low = [](const Imath::V3d& p, const Imath::V3d& n) {
        return std::abs(n.z) > 0.5 && p.y > 3 && p.y < 16 && p.x > 4 && p.x < 56;
    };
    EXPECT_GT(meanUm(young, "patina_urban_3", high), 4.0 * meanUm(young, "patina_urban_3", low) + 0.02);
    const std::vector<double> stains = sortedUm(young, "patina_urban_3", high);
    EXPECT_GT(stains[stains.size() * 9 / 10], 2.0 * stains[stains.size() / 2]); // and browner between them
    EXPECT_GT(stains[stains.size() * 9 / 10], 4.0 * stains[stains.size() / 4]);
    const auto south = [](const Imath::V3d& p, const Imath::V3d& n) { return onSouthSide(p, n); };
    const auto& layers = young.volume->layers();
    ASSERT_GE(layers.size(), 2u);
    EXPECT_GT(meanUm(young, layers.front(), south), 0.1);
}

} // namespace
} // namespace patina
