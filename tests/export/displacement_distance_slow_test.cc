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
    test::expectTheVoxelSurface(measured, 1000000);
    // As it is, with the scan's edges, which the lattice rounds by up to half a voxel.
    EXPECT_LT(measured.displaced.meshAsItIs.rms, 0.05);
    EXPECT_LT(measured.displaced.meshAsItIs.p999, 0.4);
    // A coat of 4 to 8 voxels is wider than many of the statue's creases: an eighth of it is folds, which are left out.
    EXPECT_LT(measured.foldFraction, 0.14);
    EXPECT_LT(measured.displaced.meshToVolume.maskedShare(), 0.16);
    EXPECT_LT(measured.displaced.volumeToMesh.maskedShare(), 0.06);
}

TEST(DisplacementDistance, AScanWithoutUvsHasChartsWithoutJumpsAtTheirSeams) {
    const auto file = std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/meshes/happy_buddha_60k_uv.obj";
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no ../shared";
    Mesh mesh = readMesh(file);
    makeProjectedCharts(mesh, {0, 1, 0}, 2048);
    const test::Measured measured = test::measure(std::move(mesh), 192, 2048, 3, false);
    test::expectControl(measured);
    test::expectTheVoxelSurface(measured, 100000);
    ASSERT_GT(measured.seams.size(), 1000u);
    EXPECT_LT(measured.seamsUnder(0.99), 0.02);
}

TEST(DisplacementDistance, TheDisplacedCageOfSpotWithItsOwnUvsIsTheVoxelSurface) {
    const test::Measured measured =
        test::measure(readMesh(PATINA_SOURCE_DIR "/data/meshes/spot_control_mesh.obj"), 512, 4096, 2, false);
    test::expectControl(measured);
    test::expectTheVoxelSurface(measured, 500000);
    EXPECT_LT(measured.foldFraction, 0.03);
    EXPECT_LT(measured.displaced.meshToVolume.maskedShare(), 0.04);
    EXPECT_LT(measured.displaced.volumeToMesh.maskedShare(), 0.01);
}

} // namespace
} // namespace patina
