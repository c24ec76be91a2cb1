// The displaced mesh is the voxel surface: what a displacement map is for; on a scan and on a cage, as fine as maps get.

#include "displaced_model.h"

#include "surface/mesh_file.h"

#include <filesystem>

namespace patina {
namespace {

TEST(DisplacementDistance, TheDisplacedScanOfTheBuddhaIsTheVoxelSurface) {
    const auto file = std::filesystem::path(PATINA_SOURCE_DIR) / "../shared/data/meshes/happy_buddha_60k_uv.obj";
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no ../shared";
    const test::Measured measured = test::measure(readMesh(file), 512, 4096, 6, false);
    test::expectControl(measured);
    // Measured: 0.054 and 0.378 from the mesh, 0.039 and 0.351 to it. What is left lies beside the folds, where
    // neighbouring texels end on different sheets, and on the scan's edges, where normals turn within a texel.
    EXPECT_LT(measured.displaced.meshToVolume.rms, 0.06);
    EXPECT_LT(measured.displaced.volumeToMesh.rms, 0.045);
    for (const auto& figures : {measured.displaced.meshToVolume, measured.displaced.volumeToMesh})
        EXPECT_LT(figures.p999, 0.4);
    // A coat of 4 to 8 voxels is wider than many of the statue's creases: a tenth of it is folds, which are left out.
    EXPECT_LT(measured.foldFraction, 0.11);
    const auto masked = [](const test::DistanceFigures& figures) {
        return double(figures.masked) / double(figures.masked + figures.points);
    };
    EXPECT_LT(masked(measured.displaced.meshToVolume), 0.16);
    EXPECT_LT(masked(measured.displaced.volumeToMesh), 0.045);
}

TEST(DisplacementDistance, TheDisplacedCageOfSpotWithItsOwnUvsIsTheVoxelSurface) {
    const test::Measured measured =
        test::measure(readMesh(PATINA_SOURCE_DIR "/data/meshes/spot_control_mesh.obj"), 512, 4096, 2, false);
    test::expectControl(measured);
    // Measured: 0.0066 and 0.051 from the mesh, 0.0038, 0.023 and at most 0.39 to it; the largest from the mesh, 1.7, where
    // horns and ears grow together. 2.9 % of the mesh and 0.06 % of the volume lie under the fold mask.
    for (const auto& figures : {measured.displaced.meshToVolume, measured.displaced.volumeToMesh}) {
        EXPECT_GT(figures.points, 500000u);
        EXPECT_LT(figures.rms, 0.01);
        EXPECT_LT(figures.p999, 0.08);
        EXPECT_LT(static_cast<double>(figures.masked), 0.04 * static_cast<double>(figures.points));
    }
    EXPECT_LT(measured.displaced.volumeToMesh.max, 0.5);
    EXPECT_LT(measured.foldFraction, 0.02);
}

} // namespace
} // namespace patina
