#include "base/random.h"
#include "operators/coat.h"
#include "operators/erode.h"
#include "support/test_surfaces.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace patina {
namespace {

// A random sequence of operators with random maps, the same for the same number.
void randomOperations(test::Piece& piece, int sequence) {
    const KeyedRandom random(sequence, "operators", "test");
    auto work = piece.work();
    for (int i = 0; i < 6; ++i) {
        const auto u = random.uniforms(i, 0, 0, 0);
        const Imath::V3d axis(u[1] - 0.5, u[2] - 0.5, u[3] - 0.5);
        const double frequency = 0.2 + u[1];
        const test::FunctionMap map(
            [=](const MapPoint& point) { return 0.5 + 0.5 * std::sin(frequency * point.position.dot(axis)); });
        const double thickness = std::pow(10.0, -2.5 + 3.0 * u[2]); // 0.003 … 3 voxels
        if (u[0] < 0.6)
            coat(work, "layer" + std::to_string(int(u[3] * 3)), thickness, u[3] < 0.8 ? &map : nullptr, piece.progress);
        else
            erode(work, thickness, &map, {}, piece.progress);
    }
}

void expectInvariants(LayerVolume& volume, int sequence) {
    const NestGrids& grids = volume.grids();
    const auto nest = grids.nest();
    for (std::size_t k = 1; k < nest.size(); ++k) {
        ASSERT_TRUE(nest[k]->tree().hasSameTopology(nest[0]->tree())) << sequence;
        const auto below = leavesOf(nest[k - 1]->tree()), here = leavesOf(nest[k]->tree());
        bool anywhere = false;
        for (std::size_t n = 0; n < here.size(); ++n)
            for (auto voxel = here[n]->cbeginValueOn(); voxel; ++voxel) {
                ASSERT_LE(*voxel, below[n]->getValue(voxel.pos())) << sequence;
                anywhere = anywhere || *voxel < below[n]->getValue(voxel.pos());
            }
        ASSERT_TRUE(anywhere) << "a layer that is nowhere was kept, sequence " << sequence;
    }
    for (int k = 1; k < volume.layerCount(); ++k)
        ASSERT_NE(volume.layers()[k], volume.layers()[k - 1]) << sequence;
    ASSERT_EQ(updateMaterialIds(volume), 0u) << "IDs were not true, sequence " << sequence;
}

TEST(Nest, StaysNestedWithTrueIdsThroughRandomOperations) {
    for (int sequence = 0; sequence < 40; ++sequence) {
        const auto piece = test::makePiece(test::sphere(9.f, 3), test::voxelScale(), 8.0);
        randomOperations(*piece, sequence);
        expectInvariants(*piece->volume, sequence);
    }
}

TEST(Nest, HasTheSameBitsOnAnyNumberOfThreads) {
    for (int sequence = 100; sequence < 106; ++sequence) {
        std::string first;
        for (const std::size_t threads : {1, 2, 4}) {
            tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            const auto piece = test::makePiece(test::sphere(12.f, 3), test::voxelScale(), 8.0);
            randomOperations(*piece, sequence);
            const std::string hash = contentHash(*piece->volume);
            if (first.empty())
                first = hash;
            ASSERT_EQ(hash, first) << sequence << " on " << threads;
        }
    }
}

} // namespace
} // namespace patina
