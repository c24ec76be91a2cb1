// What is promised of a whole statue. Minutes, so apart from the other tests.

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/fields/accessibility.h"
#include "support/closed_levels.h"
#include "support/six_layers.h"
#include "support/statue.h"
#include "volume/memory_formula.h"
#include "volume/stack_probe.h"

#include <gtest/gtest.h>

#include <ctime>

namespace patina {
namespace {

// Work goes with the surface, four times as much at half the voxel size; the scan's own costs stay what they are. The
// processors' time, which what else runs on the machine hardly changes.
TEST(Statue, SixLayersTakeAtMostFourTimesAsLongAtDoubledResolution) {
    double before = 0.0;
    for (const int voxels : {128, 256, 512}) {
        const std::clock_t begin = std::clock();
        const auto piece = test::makeStatue(voxels);
        if (!piece)
            GTEST_SKIP() << "no Happy Buddha beside the project";
        test::laySixLayers(*piece, voxels);
        const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
        std::printf("%d voxels: %.2f s of the processors\n", voxels, seconds);
        EXPECT_GT(piece->volume->layerCount(), 5);
        if (before > 0.0) {
            EXPECT_LE(seconds, 4.4 * before) << voxels;
        }
        before = seconds;
    }
}

TEST(Statue, FilmsAtTrueScaleStandToHalfAPercent) {
    // 391 µm a voxel: films of 0.0009 … 0.008 voxel, and 0.5 µm of the last taken off again.
    const auto piece = test::makeStatue(512);
    if (!piece)
        GTEST_SKIP() << "no Happy Buddha beside the project";
    const std::vector<double> films = {0.35, 1.2, 3.0, 1.8};
    Workpiece work = piece->work();
    for (std::size_t k = 0; k < films.size(); ++k)
        coat(work, "film" + std::to_string(k), films[k], nullptr, piece->progress);
    erode(work, 0.5, nullptr, {}, piece->progress);
    const std::vector<double> expected = {0.35, 1.2, 3.0, 1.3};
    ASSERT_EQ(piece->volume->layerCount(), 4);
    const StackProbe probe(*piece->volume);
    const double voxelSize = piece->volume->scale().voxelSize;
    const auto expectThicknesses = [&](const char* where, std::size_t places, const auto& placeOf) {
        std::vector<double> um(4), sum(4, 0.0);
        std::vector<std::vector<double>> errors(4);
        for (std::size_t i = 0; i < places; i += 3) {
            const auto [position, normal] = placeOf(i);
            if (!probe.read(position, normal, um.data()).found)
                continue; // inside another part of the scan
            for (int k = 0; k < 4; ++k) {
                sum[k] += um[k];
                errors[k].push_back(std::abs(um[k] / expected[k] - 1.0));
            }
        }
        const auto count = static_cast<double>(errors[0].size());
        EXPECT_GT(count, 0.97 * double(places) / 3.0) << where;
        for (int k = 0; k < 4; ++k) {
            std::sort(errors[k].begin(), errors[k].end());
            const double mean = sum[k] / count / expected[k] - 1.0;
            const double most = errors[k][errors[k].size() * 99 / 100];
            std::printf(
                "%s, film %d: mean %+.3f %%, 99 %% of the area within %.3f %%, at most %.1f %%, read %zu of %zu\n",
                where, k, 100.0 * mean, 100.0 * most, 100.0 * errors[k].back(), errors[k].size(), places / 3);
            EXPECT_NEAR(mean, 0.0, 0.005) << where << k;
            EXPECT_LT(most, 0.005) << where << k;
        }
    };
    const SurfaceVoxels surface = findSurfaceVoxels(*piece->volume, 0);
    expectThicknesses("along the voxels' normals", surface.size(), [&](std::size_t i) {
        return std::pair(Imath::V3d(surface.feet[i]) * voxelSize, Imath::V3d(surface.normals[i]));
    });
    // A facet leans over the voxels at every crease of the scan.
    const SurfaceMesh& scan = piece->surface;
    expectThicknesses("along the facets' normals", scan.triangles.size(), [&](std::size_t i) {
        const auto corner = [&](int c) { return Imath::V3d(scan.positions[scan.triangles[i][c]]); };
        const Imath::V3d a = corner(0), b = corner(1), c = corner(2);
        return std::pair((a + b + c) / 3.0, (b - a).cross(c - a).normalized());
    });
}

TEST(Statue, TakesLittleMoreMemoryThanTheVoxelsOfItsLeaves) {
    std::vector<double> bytes;
    for (const int voxels : {256, 512}) {
        const auto piece = test::makeStatue(voxels);
        if (!piece)
            GTEST_SKIP() << "no Happy Buddha beside the project";
        Workpiece work = piece->work();
        for (const char* film : {"tarnish_1", "cuprite_2", "soot"})
            coat(work, film, 1.2, nullptr, piece->progress);
        const double memory = memoryOfFormula(*piece->volume);
        std::printf("%d voxels: memory %.3f of the formula\n", voxels, memory);
        EXPECT_LE(memory, 1.15) << voxels;
        bytes.push_back(double(piece->volume->memoryBytes()));
    }
    std::printf("at twice the resolution %.2f times the memory\n", bytes[1] / bytes[0]);
    EXPECT_LE(bytes[1] / bytes[0], 4.2); // grows with the surface
    EXPECT_GE(bytes[1] / bytes[0], 2.0); // and is not mostly what any volume takes
}

struct Agreement {
    double filled = 0.0; ///< part of the points where the closing changes a bit
    double agree = 0.0;  ///< part where that is so exactly where the largest tangent sphere is smaller than r
    double close = 0.0;  ///< the same, or the sphere within a voxel of r
};

// Miller's two versions of offset at every surface voxel: the closing by r, as `offset` applies it, leaves the voxel's
// level alone bit for bit; the largest sphere that touches the voxel's foot is at least as large as r.
Agreement agreement(test::Piece& piece, const SurfaceVoxels& surface, const std::vector<float>& radii, double r) {
    ClosingOptions options;
    options.radius = r * piece.volume->scale().voxelSize;
    const test::ClosedLevels closed(*piece.volume, options, piece.progress);
    Agreement result;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const bool alone = closed.filled(surface.voxels[i]) == 0.f, fits = radii[i] >= r;
        result.filled += !alone;
        result.agree += alone == fits;
        result.close += alone == fits || std::abs(radii[i] - r) <= 1.0;
    }
    for (double* part : {&result.filled, &result.agree, &result.close})
        *part /= double(surface.size());
    std::printf("r %g: filled %.2f %%, agree %.3f %%, with those within a voxel of r %.3f %%\n", r,
                100.0 * result.filled, 100.0 * result.agree, 100.0 * result.close);
    return result;
}

// 0.995 is asked at every r.
void expectAgreement(int voxels, SubdivisionScheme scheme) {
    const auto piece = test::makeStatue(voxels, scheme);
    if (!piece)
        GTEST_SKIP() << "no Happy Buddha beside the project";
    const SurfaceVoxels surface = findSurfaceVoxels(*piece->volume, 0);
    const auto radii = accessibleRadii(*piece->volume, surface, 0, 20.0, false, piece->progress);
    for (const double r : {2.0, 4.0, 8.0, 16.0}) {
        const Agreement found = agreement(*piece, surface, radii, r);
        EXPECT_GT(found.filled, r < 3.0 ? 0.05 : 0.1) << r; // enough on either side
        EXPECT_LT(found.filled, 0.9) << r;
        EXPECT_GT(found.agree, 0.999) << r;
        EXPECT_GT(found.close, 0.9995) << r;
    }
}

TEST(Statue, TheTwoVersionsOfOffsetAgreeOnASmoothSurface) {
    expectAgreement(256, SubdivisionScheme::loop);
}

TEST(Statue, TheTwoVersionsOfOffsetAgreeOnTheScan) {
    expectAgreement(256, SubdivisionScheme::none);
}

TEST(Statue, TheTwoVersionsOfOffsetAgreeOnTheScanAt512) {
    expectAgreement(512, SubdivisionScheme::none);
}

} // namespace
} // namespace patina
