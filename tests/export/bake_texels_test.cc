// What a texel shows that is wider than the relief, or lies at a layer's edge or at a chart's.

#include "export/bake.h"

#include "operators/coat.h"
#include "optics/material_library.h"
#include "support/test_surfaces.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

namespace patina {
namespace {

constexpr float side = 64.f; // voxels, and so micrometres and scene units

class BakeTexels : public testing::Test {
  protected:
    using Function = std::function<double(const MapPoint&)>;

    // A sheet of 64 voxels under a coat of cuprite.
    void make(double thickness, const Function& map, SurfaceMesh surface = test::sheet(side, 32)) {
        piece_ = test::makePiece(std::move(surface), test::voxelScale(), 6.0);
        auto work = piece_->work();
        const test::FunctionMap factor(map);
        coat(work, "cuprite_2", thickness, &factor, piece_->progress);
    }
    StackOptics optics() const { return StackOptics({&library_.at("copper"), &library_.at("cuprite_2")}); }
    MapSet bakeAt(int resolution) const {
        BakeOptions options;
        options.resolution = resolution;
        Progress progress;
        return bake(*piece_->volume, piece_->surface, optics(), options, progress);
    }
    static double at(const MapSet& maps, const char* name, int x, int y, int channel = 0) {
        const MapImage& map = *maps.find(name);
        const std::size_t i = (static_cast<std::size_t>(y) * map.size + x) * map.channels + channel;
        return map.isHalf ? float(map.halves[i]) : map.floats[i];
    }

    std::unique_ptr<test::Piece> piece_;
    MaterialLibrary library_ = MaterialLibrary::load(PATINA_SOURCE_DIR "/data");
};

TEST_F(BakeTexels, ReliefFinerThanATexelBecomesRoughness) {
    // 1 + 2 (1 + sin kx) / 2 µm, a wave to a texel: its slopes have the mean square (a k)² / 2.
    const double wave = 16.0, k = 2.0 * M_PI / wave, amplitude = 1.0;
    make(3.0, [&](const MapPoint& p) { return (2.0 + amplitude * std::sin(k * p.position.x)) / 3.0; });
    const MapSet maps = bakeAt(4);
    double alpha2 = 0.0;
    Appearance look;
    for (int i = 0; i < 64; ++i) {
        const auto um = static_cast<float>(2.0 + amplitude * std::sin(2.0 * M_PI * (i + 0.5) / 64.0));
        optics().evaluate(&um, look);
        alpha2 += std::pow(look.flattenedRoughness, 4) / 64.0;
    }
    const double expected = 0.5 * amplitude * amplitude * k * k;
    for (int y = 1; y < 3; ++y)
        for (int x = 1; x < 3; ++x) {
            // Four points to a wave read the mean square exactly; the lattice flattens slopes by sinc²(pi / 16) = 0.987.
            EXPECT_NEAR(std::pow(at(maps, "roughness", x, y), 4) - alpha2, expected, 0.06 * expected) << x << " " << y;
            EXPECT_NEAR(at(maps, "displacement", x, y), 2.0, 0.02);
            EXPECT_NEAR(at(maps, "thickness_01_cuprite_2", x, y), 2.0, 0.02);
        }
    EXPECT_EQ(maps.summary.supersampledFraction, 1.0);
}

TEST_F(BakeTexels, WithoutReliefRoughnessIsTheMaterials) {
    make(2.0, [](const MapPoint&) { return 1.0; });
    Appearance look;
    const float um = 2.f;
    optics().evaluate(&um, look);
    for (const int resolution : {4, 128}) {
        const MapSet maps = bakeAt(resolution);
        EXPECT_NEAR(at(maps, "roughness", resolution / 2, resolution / 2), look.flattenedRoughness, 2e-3) << resolution;
        EXPECT_EQ(maps.summary.supersampledFraction, resolution == 4 ? 1.0 : 0.0);
    }
}

// A layer where x + y / 2 > 48: how much of a texel it covers.
double covered(double x0, double y0, double width) {
    double sum = 0.0;
    for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i)
            sum += x0 + width * (i + 0.5) / 64 + 0.5 * (y0 + width * (j + 0.5) / 64) > 48.0;
    return sum / 4096.0;
}

TEST_F(BakeTexels, CoverageIsTheShareOfTheTexelThatTheLayerCovers) {
    make(2.0, [](const MapPoint& p) { return p.position.x + 0.5 * p.position.y > 48.0 ? 1.0 : 0.0; });
    const MapSet maps = bakeAt(8); // 8 voxels a texel, 16 points
    Appearance bare, thick;
    const float none = 0.f, um = 2.f;
    optics().evaluate(&none, bare);
    optics().evaluate(&um, thick);
    int mixed = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const double share = covered(8.0 * x, 64.0 - 8.0 * (y + 1), 8.0);
            const double coverage = at(maps, "coverage_01_cuprite_2", x, y);
            // The lattice spreads the layer's edge over up to two voxels, a quarter of the texel; a row of points is
            // another eighth.
            EXPECT_NEAR(coverage, share, 0.375) << x << " " << y;
            EXPECT_NEAR(coverage * 16.0, std::round(coverage * 16.0), 0.02);
            mixed += coverage > 0.01 && coverage < 0.99;
            const double most = std::max(bare.diffuse.x, thick.diffuse.x), least = std::min(bare.diffuse.x, thick.diffuse.x);
            EXPECT_LE(at(maps, "diffuse", x, y), most + 0.01);
            EXPECT_GE(at(maps, "diffuse", x, y), least - 0.01);
            if (share == 0.0 || share == 1.0) {
                EXPECT_NEAR(at(maps, "thickness_01_cuprite_2", x, y), 2.0 * share, 0.5) << x << " " << y;
            }
        }
    EXPECT_GE(mixed, 8);
}

TEST_F(BakeTexels, FineTexelsAreReadAgainAtALayersEdgeAlone) {
    make(2.0, [](const MapPoint& p) { return p.position.x + 0.5 * p.position.y > 48.0 ? 1.0 : 0.0; });
    const int size = 100; // 0.64 voxel a texel, so that the lattice's lines, where a layer ends, run through texels
    const MapSet maps = bakeAt(size);
    // The edge is as many texels high as the map, and at most three texels are beside it in each row, and the next row's.
    EXPECT_GT(maps.summary.supersampledFraction, 1.5 / size);
    EXPECT_LT(maps.summary.supersampledFraction, 6.0 / size);
    int quarters = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double coverage = at(maps, "coverage_01_cuprite_2", x, y);
            EXPECT_EQ(coverage * 4.0, std::round(coverage * 4.0));
            quarters += coverage > 0.0 && coverage < 1.0;
        }
    EXPECT_GT(quarters, size / 4);
}

TEST_F(BakeTexels, NormalsHoldOnSkewedAndMirroredUvs) {
    // A ramp of 1 in 16 along x.
    const Imath::V3d expected = Imath::V3d(-1.0 / 16.0, 0.0, 1.0).normalized();
    for (const bool mirrored : {false, true}) {
        SurfaceMesh surface = test::sheet(side, 32);
        for (auto& uv : surface.uvs) {
            uv = Imath::V2f(0.6f * uv.x + 0.2f * uv.y, 0.6f * uv.y + 0.3f * uv.x) + Imath::V2f(0.05f);
            if (mirrored)
                uv.x = 1.f - uv.x;
        }
        make(4.0, [](const MapPoint& p) { return p.position.x / side; }, surface);
        const MapSet maps = bakeAt(128);
        // dP/du of the UVs above: solve du = 0.6 dx + 0.2 dy, 0 = 0.3 dx + 0.6 dy.
        const Imath::V3d tangent = Imath::V3d(2.0, -1.0, 0.0).normalized() * (mirrored ? -1.0 : 1.0);
        const Imath::V3d bitangent = Imath::V3d(0, 0, 1).cross(tangent) * (mirrored ? -1.0 : 1.0);
        for (const Imath::V2d& place : {Imath::V2d(0.3, 0.3), Imath::V2d(0.5, 0.6), Imath::V2d(0.7, 0.4)}) {
            Imath::V2d uv(0.6 * place.x + 0.2 * place.y + 0.05, 0.6 * place.y + 0.3 * place.x + 0.05);
            if (mirrored)
                uv.x = 1.0 - uv.x;
            const int x = static_cast<int>(uv.x * 128), y = static_cast<int>((1.0 - uv.y) * 128);
            Imath::V3d code;
            for (int c = 0; c < 3; ++c)
                code[c] = 2.0 * at(maps, "normal", x, y, c) - 1.0;
            const Imath::V3d normal = tangent * code.x + bitangent * code.y + Imath::V3d(0, 0, 1) * code.z;
            EXPECT_LT((normal - expected).length(), 0.004) << mirrored << " " << place.x << " " << place.y;
        }
    }
}

TEST_F(BakeTexels, ATroughNarrowerThanItsCoatIsAFold) {
    // A trough of radius 5 across the middle of the sheet: normals meet in its axis, below the top of 8 voxels.
    SurfaceMesh surface = test::sheet(side, 128);
    for (std::size_t i = 0; i < surface.positions.size(); ++i) {
        const float x = surface.positions[i].x, half = 0.5f * static_cast<float>(M_PI) * 5.f;
        const float along = x - 0.5f * side;
        if (std::abs(along) < half) {
            const float angle = along / 5.f;
            surface.positions[i] = {0.5f * side + 5.f * std::sin(angle), surface.positions[i].y, -5.f * std::cos(angle)};
            surface.normals[i] = {-std::sin(angle), 0.f, std::cos(angle)};
        } else {
            surface.positions[i].x = x - std::copysign(half - 5.f, along);
        }
    }
    piece_ = test::makePiece(std::move(surface), test::voxelScale(), 14.0);
    auto work = piece_->work();
    coat(work, "cuprite_2", 8.0, nullptr, piece_->progress);
    BakeOptions options;
    options.resolution = 128;
    options.foldMask = true;
    Progress progress;
    const MapSet maps = bake(*piece_->volume, piece_->surface, optics(), options, progress);
    EXPECT_EQ(at(maps, "fold_mask", 64, 64), 1.0);
    EXPECT_EQ(at(maps, "fold_mask", 16, 64), 0.0);
    EXPECT_EQ(at(maps, "fold_mask", 112, 64), 0.0);
    // At most the trough, 5 pi of 64.
    EXPECT_GT(maps.summary.foldFraction, 0.1);
    EXPECT_LT(maps.summary.foldFraction, 5.0 * M_PI / side + 0.03);
}

TEST_F(BakeTexels, SeveralTilesAreBakedEachByItself) {
    SurfaceMesh surface = test::sheet(side, 32);
    for (auto& uv : surface.uvs)
        uv.x = uv.x * 2.f;
    make(2.0, [](const MapPoint& p) { return p.position.x < 0.5 * side ? 0.5 : 1.0; }, surface);
    const MapSet maps = bakeAt(32);
    ASSERT_EQ(maps.summary.tiles, (std::vector<Imath::V2i>{{0, 0}, {1, 0}}));
    EXPECT_EQ(maps.summary.coveredFraction, 1.0);
    std::vector<const MapImage*> heights;
    for (const MapImage& map : maps.maps)
        if (map.name == "displacement")
            heights.push_back(&map);
    ASSERT_EQ(heights.size(), 2u);
    EXPECT_EQ(heights[0]->fileStem(), "displacement.1001");
    EXPECT_EQ(heights[1]->fileStem(), "displacement.1002");
    EXPECT_NEAR(heights[0]->floats[16 * 32 + 10], 1.0, 0.02);
    EXPECT_NEAR(heights[1]->floats[16 * 32 + 20], 2.0, 0.02);
}

TEST_F(BakeTexels, AreTheSameOnAnyNumberOfThreads) {
    make(2.0, [](const MapPoint& p) { return p.position.x + 0.5 * p.position.y > 48.0 ? 1.0 : 0.3; });
    std::vector<std::vector<float>> floats;
    for (const std::size_t threads : {1, 3}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const MapSet maps = bakeAt(100); // not a whole number of bands
        std::vector<float> all{float(maps.summary.meanColour.x), maps.summary.maxDisplacement};
        for (const MapImage& map : maps.maps) {
            all.insert(all.end(), map.floats.begin(), map.floats.end());
            all.insert(all.end(), map.halves.begin(), map.halves.end());
        }
        floats.push_back(std::move(all));
    }
    EXPECT_EQ(floats[0], floats[1]);
}

} // namespace
} // namespace patina
