// The displaced mesh is the voxel surface: what a displacement map is for; on a scan and on a cage, as fine as maps get.

#include "displaced_model.h"

#include "surface/mesh_file.h"
#include "surface/region_charts.h"

#include <filesystem>

namespace patina {
namespace {

TEST(DisplacementDistance, TheDisplacedScanOfTheBuddhaIsTheVoxelSurface) {
    const auto file = std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/meshes/happy_buddha_60k_uv.obj";
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no ../shared";
    const test::Measured measured = test::measure(readMesh(file), 512, 4096, 10, false);
    test::expectControl(measured);
    test::expectTheVoxelSurface(measured, 500000);
    // As it is, with the scan's edges, which the lattice rounds by up to half a voxel.
    EXPECT_LT(measured.displaced.meshAsItIs.rms, 0.05);
    EXPECT_LT(measured.displaced.meshAsItIs.p999, 0.4);
    ASSERT_GT(measured.seams.size(), 10000u);
    EXPECT_LT(measured.seams.back(), 0.02);
    // Under the mask, at walls, a height map cannot close all of them.
    ASSERT_GT(measured.foldedSeams.size(), 10000u);
    EXPECT_LT(measured.openFoldedShare(), 0.05);
    // A coat of 4 to 8 voxels is wider than many of the statue's creases: an eighth of it is folds, which are left out.
    EXPECT_LT(measured.foldFraction, 0.14);
    EXPECT_LT(measured.displaced.meshToVolume.maskedShare(), 0.16);
    EXPECT_LT(measured.displaced.volumeToMesh.maskedShare(), 0.06);
}

TEST(DisplacementDistance, AScanWithoutUvsIsTheVoxelSurfaceThroughItsCharts) {
    const auto file = std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/meshes/happy_buddha_60k_uv.obj";
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no ../shared";
    Mesh mesh = readMesh(file);
    makeProjectedCharts(mesh, {0, 1, 0}, 2048);
    const test::Measured measured = test::measure(std::move(mesh), 160, 2048, 3, false);
    test::expectControl(measured);
    // A coat of 4 to 8 voxels on 160 leaves little beside folds, and texels of half a voxel. Measured: 0.035 and 0.25, at
    // most 0.66, from the mesh, 0.037, 0.27 and 0.82 to it.
    for (const auto& figures : {measured.displaced.meshToVolume, measured.displaced.volumeToMesh}) {
        EXPECT_GT(figures.points, 20000u);
        EXPECT_LT(figures.rms, 0.05);
        EXPECT_LT(figures.p999, 0.3);
        EXPECT_LT(figures.max, 1.0);
    }
    ASSERT_GT(measured.seams.size(), 1000u);
    EXPECT_LT(measured.seams.back(), 0.02);
}

TEST(DisplacementDistance, TheDisplacedCageOfSpotWithItsOwnUvsIsTheVoxelSurface) {
    const test::Measured measured =
        test::measure(readMesh(PATINA_SOURCE_DIR "/data/meshes/spot_control_mesh.obj"), 512, 4096, 2, false);
    test::expectControl(measured);
    // Spot's UVs are stretched in places: 2 % of its points lie on texels wider than a voxel.
    test::expectTheVoxelSurface(measured, 500000);
    EXPECT_GT(measured.displaced.fineTexels.points, measured.displaced.meshToVolume.points * 95 / 100);
    EXPECT_LT(measured.displaced.fineTexels.max, 0.5);
    ASSERT_GT(measured.seams.size(), 10000u);
    EXPECT_LT(measured.seams.back(), 0.02);
    EXPECT_LT(measured.foldFraction, 0.03);
    EXPECT_LT(measured.displaced.meshToVolume.maskedShare(), 0.04);
    EXPECT_LT(measured.displaced.volumeToMesh.maskedShare(), 0.01);
}

} // namespace
} // namespace patina
