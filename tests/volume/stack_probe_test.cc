#include "volume/stack_probe.h"

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

namespace patina {
namespace {

// Moves the top interface out by t voxels everywhere: exact on a true distance field.
void shiftTop(LayerVolume& volume, float t) {
    for (FloatLeaf* leaf : leavesOf(volume.grids().surface().tree()))
        for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
            voxel.setValue(*voxel - t);
}

TEST(StackProbe, ReadsFilmsFarBelowAVoxel) {
    const auto piece = test::makePiece(test::sphere(40.f, 5), test::voxelScale());
    const std::vector<float> films = {0.0009f, 0.003f, 0.0077f, 0.3f};
    for (std::size_t k = 0; k < films.size(); ++k) {
        piece->volume->pushLayer("film" + std::to_string(k));
        shiftTop(*piece->volume, films[k]);
    }
    const StackProbe probe(*piece->volume);
    std::vector<double> um(films.size());
    for (std::size_t v = 0; v < piece->surface.positions.size(); v += 17) {
        const auto reading =
            probe.read(Imath::V3d(piece->surface.positions[v]), Imath::V3d(piece->surface.normals[v]), um.data());
        ASSERT_TRUE(reading.found);
        // The sphere has facets of 1.5 voxels: its trilinear field is steeper or flatter than 1 by up to two percent
        // there.
        for (std::size_t k = 0; k < films.size(); ++k)
            ASSERT_NEAR(um[k], films[k], 0.03 * films[k]) << k;
    }
}

TEST(StackProbe, ALayerOfNothingReadsAsNothing) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    piece->volume->pushLayer("nothing");
    const StackProbe probe(*piece->volume);
    double um = -1.0;
    for (std::size_t v = 0; v < piece->surface.positions.size(); ++v) {
        const auto reading =
            probe.read(Imath::V3d(piece->surface.positions[v]), Imath::V3d(piece->surface.normals[v]), &um);
        ASSERT_TRUE(reading.found);
        ASSERT_NEAR(um, 0.0, 1e-9);
        ASSERT_NEAR(reading.height, 0.0, 1e-9);
    }
}

TEST(StackProbe, SaysWhereThereIsNoMetal) {
    const auto piece = test::makePiece(test::sphere(20.f, 4), test::voxelScale());
    const StackProbe probe(*piece->volume);
    double none = 0.0;
    EXPECT_FALSE(probe.read({100.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, &none).found);
}

TEST(StackProbe, ExaggeratedThicknessIsReadAsReal) {
    VolumeScale scale = test::voxelScale();
    scale.exaggeration = 50.0;
    const auto piece = test::makePiece(test::sphere(40.f, 5), scale);
    piece->volume->pushLayer("film");
    shiftTop(*piece->volume, 0.5f); // drawn
    const StackProbe probe(*piece->volume);
    double um = 0.0;
    const auto reading = probe.read({0.0, 0.0, 40.0}, {0.0, 0.0, 1.0}, &um);
    EXPECT_NEAR(um, 0.01, 2e-4);
    EXPECT_NEAR(reading.height, 0.5, 0.01);
}

} // namespace
} // namespace patina
