// Growth as scripts ask for it: one look whatever the voxels, where particles come from, what the report says.

#include "script/interpreter.h"

#include "optics/colour.h"
#include "optics/layer_stack.h"
#include "support/correlation_length.h"
#include "support/test_surfaces.h"
#include "volume/nest_grids.h"
#include "volume/region_model.h"
#include "volume/stack_probe.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace patina {
namespace {

/// A scene unit is a micrometre.
class GrowthRun : public testing::Test {
  protected:
    GrowthRun() {
        initializeVolumes();
        materials_ = MaterialLibrary::load(std::string(PATINA_SOURCE_DIR) + "/data");
        options_.scale = test::voxelScale();
        options_.longestSide = 40.0;
        options_.seed = 5;
    }

    RunResult run(const std::string& text, const SurfaceMesh& surface) {
        CheckContext context;
        declareAbilities(context, materials_);
        program_ = readProgram("new copper\n" + text, "test.patina", context);
        return runProgram(program_, surface, materials_, options_, progress_);
    }

    static double thicknessAt(const LayerVolume& volume, const Imath::V3d& point, const Imath::V3d& normal) {
        std::vector<double> um(std::size_t(volume.layerCount()));
        StackProbe(volume).read(point, normal, um.data());
        return um.back();
    }

    MaterialLibrary materials_;
    RunOptions options_;
    Progress progress_;
    Program program_;
};

// Voxels of 1/256, 1/512 and 1/1024 of the model, of which the plate is a small piece; cells of 1/512 by default, and
// of a size that the script gives.
TEST_F(GrowthRun, aPreviewAndAFinalShowTheSamePattern) {
    constexpr double side = 28.0;
    options_.longestSide = 256.0;
    // The last is up to 20 voxels thick, its levels a fifth to nearly a whole voxel.
    for (const char* growth :
         {"0.9 texture(RDR(rate=linear, step=10, total=20))", "0.9 texture(BD(rate=linear, step=10, total=20))",
          "0.9 texture(DPD(rate=linear, step=10, total=20, seeding=0.005, patch=6))",
          "0.9 texture(RDR(rate=linear, step=10, total=20, cell=1um))",
          "0.9 texture(BD(rate=linear, step=10, total=20, cell=1um))",
          "5 texture(BD(rate=linear, step=20, total=20, cell=1um))",
          // Particles, 0.56 to 2.2 voxels high.
          "4.6 texture(BD(rate=linear, step=4, total=4, cell=1um))"}) {
        double length[3];
        for (const int n : {0, 1, 2}) {
            options_.scale.voxelSize = 1.0 / (1 << n);
            const RunResult result = run(fmt::format("coat brochantite {}", growth), test::sheet(float(side), 14));
            length[n] = test::correlationLength(*result.volume, side);
        }
        RecordProperty(growth, fmt::format("{:.3f} {:.3f} {:.3f}", length[0], length[1], length[2]));
        EXPECT_NEAR(length[0] / length[2], 1.0, 0.1) << growth;
        EXPECT_NEAR(length[1] / length[2], 1.0, 0.1) << growth;
    }
}

TEST_F(GrowthRun, cellsAndVoxelsOfOneScriptLookAlikeOnABall) {
    const SurfaceMesh ball = test::sphere(24.f, 5);
    const StackOptics optics({&materials_.at("copper"), &materials_.at("brochantite")});
    for (const char* model : {"RD", "RDR", "BD", "DPD"}) {
        double um[2] = {};
        Imath::V3d lab[2];
        for (const int n : {0, 1}) {
            options_.scale.voxelSize = n == 0 ? 1.15 : 0.8; // 3.8 and 5.5 voxels
            const RunResult result =
                run(fmt::format("coat brochantite 4.4 texture({}(rate=linear, step=10, total=20, cell=1um{}))", model,
                                model == std::string("DPD") ? ", seeding=0.003" : ""),
                    ball);
            const StackProbe probe(*result.volume);
            Appearance look;
            Imath::V3d colour(0.0);
            for (const Imath::V3i& t : ball.triangles) {
                const Imath::V3d p(ball.positions[t.x] + ball.positions[t.y] + ball.positions[t.z]);
                double here = 0.0;
                probe.read(p / 3.0, p.normalized(), &here);
                um[n] += here / double(ball.triangles.size());
                const auto thickness = static_cast<float>(here);
                optics.evaluate(&thickness, look);
                colour += Imath::V3d(look.baseColour) / double(ball.triangles.size());
            }
            lab[n] = labFromXyz(xyzFromLinearRec709(colour));
        }
        RecordProperty(model, fmt::format("{:.4f} {:.2f}", um[1] / um[0], deltaE2000(lab[0], lab[1])));
        EXPECT_NEAR(um[1] / um[0], 1.0, 0.02) << model;
        EXPECT_LT(deltaE2000(lab[0], lab[1]), 2.0) << model;
    }
}

/// A sheet, and a smaller one ten units above it.
SurfaceMesh roofedSheet() {
    SurfaceMesh ground = test::sheet(40.f, 20);
    const SurfaceMesh roof = test::sheet(12.f, 6);
    const int first = int(ground.positions.size()), faces = int(ground.triangleFaces.size()) / 2;
    for (std::size_t i = 0; i < roof.positions.size(); ++i) {
        ground.positions.push_back(roof.positions[i] + Imath::V3f(14.f, 14.f, 10.f));
        ground.normals.push_back(roof.normals[i]);
        ground.uvs.push_back(roof.uvs[i]);
    }
    for (std::size_t t = 0; t < roof.triangles.size(); ++t) {
        ground.triangles.push_back(roof.triangles[t] + Imath::V3i(first));
        ground.triangleUvs.push_back(roof.triangleUvs[t] + Imath::V3i(first));
        ground.triangleFaces.push_back(roof.triangleFaces[t] + faces);
    }
    return ground;
}

TEST_F(GrowthRun, particlesFromADirectionLeaveTheObjectsOwnShadow) {
    const SurfaceMesh surface = roofedSheet();
    const Imath::V3d up(0, 0, 1);
    for (const double um : {2.0, 6.0}) // on cells, in voxels
        for (const char* model : {"RD", "BD"}) {
            const auto grown = [&](const char* from) {
                return run(fmt::format("coat soot {}um texture({}(rate=linear, step=12, total=12, cell=1um, from={}))",
                                       um, model, from),
                           surface);
            };
            const auto mean = [&](const RunResult& result, double x0, double x1) {
                double sum = 0.0;
                int count = 0;
                // Behind the roof as wide as it is; elsewhere over the whole sheet.
                const bool shade = x1 < 25.0;
                for (double x = x0; x <= x1; x += 1.0)
                    for (double y = shade ? 17.0 : 4.0; y <= (shade ? 23.0 : 36.0); y += 1.0, ++count)
                        sum += thicknessAt(*result.volume, {x, y, 0.0}, up);
                return sum / count;
            };
            const RunResult above = grown("(0, 0, 1)"), slanting = grown("(1, 0, 1)");
            EXPECT_EQ(mean(above, 17, 23), 0.0) << model << um;
            EXPECT_GT(mean(above, 5, 10), 0.3 * um) << model << um;
            // From +x at 45 degrees the shadow lies ten units to the left, and the lit plate catches less.
            EXPECT_EQ(mean(slanting, 7, 13), 0.0) << model << um;
            EXPECT_NEAR(mean(slanting, 29, 35) / mean(above, 29, 35), std::sqrt(0.5), 0.12) << model << um;
        }
}

TEST_F(GrowthRun, slantedParticlesAreAsManyAsTheCosineSays) {
    // On cells a film, in voxels columns and particles, of no more than can lean over the sheet's borders unseen.
    const SurfaceMesh sheet = test::sheet(40.f, 20);
    for (const char* model : {"RD", "BD"})
        for (const double um : {2.0, 7.0}) {
            double mean[2] = {};
            for (const int n : {0, 1}) {
                const RunResult result =
                    run(fmt::format("coat soot {}um texture({}(rate=linear, step=2, total=2, cell=1um, from={}))", um,
                                    model, n == 0 ? "(0, 0, 1)" : "(1, 0, 1)"),
                        sheet);
                const StackProbe probe(*result.volume);
                double here = 0.0;
                for (double x = 10.05; x < 30.0; x += 0.31)
                    for (double y = 10.05; y < 30.0; y += 0.29) {
                        probe.read({x, y, 0.0}, {0, 0, 1}, &here);
                        mean[n] += here;
                    }
            }
            RecordProperty(fmt::format("{}_{}", model, um), fmt::format("{:.3f}", mean[1] / mean[0]));
            // 400 cells of two particles each: 2.5 per cent.
            EXPECT_NEAR(mean[1] / mean[0], std::sqrt(0.5), 0.05) << model << um;
        }
}

TEST_F(GrowthRun, layersThrowShadowsToo) {
    // A thick cap on a ball reaches out over what lies below its edge.
    const SurfaceMesh ball = test::sphere(16.f, 5);
    const std::string cap = "coat wax 8 clamp((facing(0, 0, 1) - 0.75) * 20, 0, 1)\n";
    const std::string soot = "coat soot 1 texture(RD(rate=linear, step=20, total=20, cell=1um, from=(0, 0, 1)))";
    const RunResult bare = run(soot, ball), shaded = run(cap + soot, ball);
    double bareUm = 0.0, shadedUm = 0.0;
    for (const Imath::V3f& n : ball.normals) {
        if (n.z < 0.6f || n.z > 0.7f) // 11.4 to 12.8 from the axis; the cap reaches to 24 sin(37°) = 14.4
            continue;
        bareUm += thicknessAt(*bare.volume, Imath::V3d(n) * 16.0, Imath::V3d(n));
        shadedUm += thicknessAt(*shaded.volume, Imath::V3d(n) * 16.0, Imath::V3d(n));
    }
    EXPECT_GT(bareUm, 1.0);
    EXPECT_LT(shadedUm, 0.1 * bareUm);
}

TEST_F(GrowthRun, arrivalThinsTheRainOfParticles) {
    const SurfaceMesh ball = test::sphere(20.f, 5);
    for (const double um : {2.0, 6.0}) {
        const RunResult result = run(
            fmt::format("coat soot {}um texture(RD(rate=linear, step=40, total=40, cell=1um, arrival=facing(0, 0, 1)))",
                        um),
            ball);
        double sum[3] = {}, count[3] = {};
        for (const Imath::V3f& n : ball.normals) {
            const int k = n.z > 0.9f ? 0 : std::abs(n.z - 0.5f) < 0.08f ? 1 : n.z < -0.05f ? 2 : -1;
            if (k < 0)
                continue;
            sum[k] += thicknessAt(*result.volume, Imath::V3d(n) * 20.0, Imath::V3d(n));
            count[k] += 1.0;
        }
        const double full = um * 40.0 / (40.0 + 3.0 * std::sqrt(40.0));
        EXPECT_NEAR(sum[0] / count[0] / full, 0.95, 0.05) << um;
        EXPECT_NEAR(sum[1] / count[1] / full, 0.5, 0.05) << um;
        EXPECT_LT(sum[2] / count[2], 0.01 * full) << um;
    }
}

TEST_F(GrowthRun, patchesKeepOffWhereWetnessBlocksThem) {
    const SurfaceMesh ball = test::sphere(20.f, 5);
    const RunResult result = run("coat brochantite 2um texture(DPD(rate=linear, step=4, total=20, cell=0.5um, "
                                 "patch=4, seeding=0.0003, blocked=wetness))",
                                 ball);
    const auto& fields = result.volume->grids().fields;
    const auto field = std::find_if(fields.begin(), fields.end(),
                                    [](const auto& entry) { return entry.first.find("wetness") != std::string::npos; });
    ASSERT_NE(field, fields.end());
    const auto wetness = field->second->getConstAccessor();
    std::vector<std::pair<double, double>> places; // how wet, how much
    for (std::size_t i = 0; i < ball.positions.size(); ++i) {
        const Imath::V3f p = ball.positions[i];
        const openvdb::Coord c = result.volume->grids().space.index(int(std::lround(p.x)), int(std::lround(p.y)),
                                                                    int(std::lround(p.z)));
        places.emplace_back(wetness.getValue(c),
                            thicknessAt(*result.volume, Imath::V3d(p), Imath::V3d(p).normalized()));
    }
    std::sort(places.begin(), places.end());
    const auto covered = [&](std::size_t from, std::size_t to) {
        return double(std::count_if(places.begin() + long(from), places.begin() + long(to),
                                    [](const auto& place) { return place.second > 0.02; })) /
               double(to - from);
    };
    const std::size_t third = places.size() / 3;
    EXPECT_GT(places.back().first, places.front().first + 0.3);
    EXPECT_GT(covered(0, third), 1.2 * covered(places.size() - third, places.size()));
}

TEST_F(GrowthRun, theReportSaysWhatHasGrown) {
    const SurfaceMesh ball = test::sphere(20.f, 5);
    const double area = ball.area(), age = 9.0;
    for (const double um : {2.0, 6.0}) {
        const RunResult result =
            run(fmt::format("coat soot {}um texture(RD(rate=linear, step=9, total=9, cell=1um))", um), ball);
        const auto& growths = result.statements.back().growths;
        ASSERT_EQ(growths.size(), 1u);
        const GrowthStatistics& s = growths.front();
        EXPECT_NEAR(double(s.particles) / area, age, 0.1);
        EXPECT_NEAR(s.mean, age, 0.1);
        EXPECT_NEAR(s.interfaceWidth, 3.0, 0.5); // cells of other areas count in other units
        EXPECT_NEAR(s.skewness, 1.0 / 3.0, 0.15);
        EXPECT_NEAR(s.coverage, 1.0, 0.005);
        EXPECT_EQ(s.density, 1.0);
        EXPECT_EQ(s.patches, 1u);
        EXPECT_NEAR(s.levelUm, um / 18.0, 1e-9); // mean and three deviations are 18 layers
    }
    for (const double um : {2.0, 16.0}) {
        const RunResult result =
            run(fmt::format("coat soot {}um texture(BD(rate=linear, step=9, total=9, cell=1um))", um), ball);
        const GrowthStatistics& s = result.statements.back().growths.front();
        EXPECT_NEAR(double(s.particles), age * area * 0.82,
                    0.05 * age * area); // a particle per cell, of 1.22 in the mean
        EXPECT_NEAR(s.density, 9.0 / s.mean, 0.03);
        EXPECT_GT(s.interfaceWidth, 2.0);
        EXPECT_EQ(s.coverage, 1.0);
        // In voxels a level is a particle; on cells the height of the envelope stands for the solid.
        const double solid = um > 4.0 ? s.density * s.mean * s.levelUm : s.mean * s.levelUm;
        EXPECT_NEAR(solid / um, 0.68, 0.08) << um;
    }
}

Mesh meshOf(const SurfaceMesh& surface) {
    Mesh mesh;
    mesh.name = "model";
    mesh.positions = surface.positions;
    for (const Imath::V3i& t : surface.triangles) {
        mesh.faceSizes.push_back(3);
        for (int c = 0; c < 3; ++c)
            mesh.faceVertices.push_back(t[c]);
    }
    return mesh;
}

TEST_F(GrowthRun, aRegionGrowsInVoxelsAsTheWholeDoes) {
    const Imath::V3d place(12.0, 20.0, 32.0);
    const Imath::Box3d box(place - Imath::V3d(8.0), place + Imath::V3d(8.0));
    for (const char* model : {"RD", "RDR", "BD", "DPD"}) {
        // BD of whole voxels; levels thinner than that would be heights of cells.
        const std::string text = fmt::format("coat soot 5um texture({}(rate=linear, step=3, total=3{}))", model,
                                             model == std::string("BD") ? "" : ", cell=1um");
        const double reach = 26.0;
        const RegionModel region(meshOf(test::sphere(40.f, 5)), makeRegion(box, 1.0, reach), {});
        ASSERT_EQ(region.region().magnification, 1.0);
        options_.longestSide = 80.0;
        options_.region = nullptr;
        const RunResult whole = run(text, region.whole());
        options_.region = &region;
        const RunResult part = run(text, region.shown());
        options_.region = nullptr;
        const auto& cut = part.volume->grids().surface();
        const auto all = whole.volume->grids().surface().getConstAccessor();
        const Imath::V3i origin = region.region().originVoxels;
        std::size_t compared = 0, bits = 0, otherSide = 0;
        double worst = 0.0;
        for (auto voxel = cut.cbeginValueOn(); voxel; ++voxel) {
            const Imath::V3i there = part.volume->grids().space.place(voxel.getCoord()) + origin;
            const openvdb::Coord c = whole.volume->grids().space.index(there);
            if (!box.intersects(Imath::V3d(there)) || !all.isValueOn(c))
                continue;
            const float a = *voxel, b = all.getValue(c);
            ++compared;
            bits += a == b;
            otherSide += (a <= 0.f) != (b <= 0.f);
            worst = std::max(worst, double(std::abs(a - b)));
        }
        RecordProperty(model,
                       fmt::format("{} voxels, {} with the same bits, largest difference {:g}", compared, bits, worst));
        EXPECT_GT(compared, 2000u) << model;
        EXPECT_EQ(otherSide, 0u) << model;
        // The lattice's heights are the same bits; phi_0 of a region is rounded in coordinates of its own.
        EXPECT_LT(worst, 2e-3) << model;
    }
}

// On cells and in voxels: means over blocks of 4 x 4 cells, of a region with voxels of half the size.
TEST_F(GrowthRun, aFinerRegionAgreesWithTheWholeInItsBlockMeans) {
    const Imath::Box3d box({-8.0, -8.0, 16.0}, {8.0, 8.0, 32.0});
    for (const double um : {2.0, 5.0})
        for (const char* model : {"RD", "RDR", "BD", "DPD"}) {
            const std::string text =
                fmt::format("coat soot {}um texture({}(rate=linear, step=4, total=4, cell=1um{}))", um, model,
                            model == std::string("DPD") ? ", seeding=0.01, patch=4" : "");
            const RegionModel region(meshOf(test::sphere(24.f, 4)), makeRegion(box, 0.5, 36.0), {});
            ASSERT_EQ(region.region().magnification, 1.0);
            options_.longestSide = 48.0;
            options_.region = nullptr;
            options_.scale.voxelSize = 1.0;
            const RunResult whole = run(text, region.whole());
            options_.region = &region;
            options_.scale.voxelSize = 0.5;
            const RunResult part = run(text, region.shown());
            options_.region = nullptr;
            double sum[2] = {}, difference = 0.0, variance = 0.0;
            std::vector<std::array<double, 2>> blocks;
            for (double x0 = -6.0; x0 < 6.0; x0 += 4.0)
                for (double y0 = -6.0; y0 < 6.0; y0 += 4.0) {
                    std::array<double, 2> block{};
                    for (double x = 0.125; x < 4.0; x += 0.25)
                        for (double y = 0.125; y < 4.0; y += 0.25) {
                            Imath::V3d n(x0 + x, y0 + y, 0.0);
                            n.z = std::sqrt(576.0 - n.length2());
                            const Imath::V3d p = n;
                            n.normalize();
                            block[0] += thicknessAt(*whole.volume, p, n) / 256.0;
                            block[1] += thicknessAt(*part.volume, region.region().toLocal(p), n) / 256.0;
                        }
                    sum[0] += block[0] / 9.0;
                    sum[1] += block[1] / 9.0;
                    blocks.push_back(block);
                }
            for (const auto& block : blocks) {
                difference += (block[1] - block[0]) * (block[1] - block[0]) / 9.0;
                variance += (block[0] - sum[0]) * (block[0] - sum[0]) / 9.0;
            }
            RecordProperty(fmt::format("{}_{}", model, um),
                           fmt::format("mean {:.4f}, rms of blocks {:.4f} of the mean, {:.4f} their deviation",
                                       sum[1] / sum[0], std::sqrt(difference) / sum[0], std::sqrt(variance) / sum[0]));
            // Of DPD, whose blocks are covered or bare, a tenth of their deviation. Another history would be 1.4 of it
            // off.
            const double deviation = std::sqrt(variance);
            EXPECT_NEAR(sum[1], sum[0], std::max(0.02 * sum[0], 0.1 * deviation)) << model << um;
            EXPECT_LT(std::sqrt(difference), 0.6 * deviation) << model << um;
        }
}

} // namespace
} // namespace patina
