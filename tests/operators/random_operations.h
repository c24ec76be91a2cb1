#pragma once
// Random sequences of all operators, and what must hold of the nest after any of them (DESIGN §1).

#include "base/random.h"
#include "operators/coat.h"
#include "operators/convert.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/grow_layer.h"
#include "operators/offset.h"
#include "operators/polish.h"
#include "support/test_surfaces.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace patina::test {

// A random sequence of operators with random maps, the same for the same number.
inline void randomOperations(Piece& piece, int sequence) {
    const KeyedRandom random(sequence, "operators", "test");
    auto work = piece.work();
    for (int i = 0; i < 7; ++i) {
        const auto u = random.uniforms(i, 0, 0, 0);
        const auto v = random.uniforms(i, 1, 0, 0);
        const Imath::V3d axis(u[1] - 0.5, u[2] - 0.5, u[3] - 0.5);
        const double frequency = 0.2 + u[1];
        const FunctionMap wave(
            [=](const MapPoint& point) { return 0.5 + 0.5 * std::sin(frequency * point.position.dot(axis)); });
        const ThicknessMap* map = u[3] < 0.8 ? &wave : nullptr;
        const double thickness = std::pow(10.0, -2.5 + 3.0 * u[2]); // 0.003 … 3 voxels
        const auto material = [](double number) { return "layer" + std::to_string(int(number * 3)); };
        const LayerHardness hardness(v[1] < 0.5 ? std::size_t(work.volume.layerCount()) : 0, 0.5 + v[2]);
        if (i == 0 || u[0] < 0.35)
            coat(work, material(v[0]), thickness, map, piece.progress);
        else if (u[0] < 0.55)
            erode(work, thickness, map, hardness, piece.progress,
                  v[3] < 0.3 ? std::optional<double>(1.0) : std::optional<double>());
        else if (u[0] < 0.65)
            fill(work, material(v[0]), thickness, map, piece.progress);
        else if (u[0] < 0.75)
            polish(work, thickness, map, piece.progress);
        else if (u[0] < 0.85)
            growLayer(work, material(v[0]), thickness, map, piece.progress);
        else if (u[0] < 0.95)
            convertLayers(work, material(v[0]), material(v[1]), v[2], map, piece.progress);
        else
            offset(work, material(v[0]), 0.5 + 4.0 * u[2], v[1] < 0.3, piece.progress);
    }
}

inline void expectInvariants(LayerVolume& volume, int sequence) {
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

/// \param threads  each sequence is run on each of these numbers of threads, with the same bits
inline void runSequences(int first, int last, const std::vector<std::size_t>& threads) {
    for (int sequence = first; sequence < last && !testing::Test::HasFatalFailure(); ++sequence) {
        std::string bits;
        for (const std::size_t count : threads) {
            tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
            const auto piece = makePiece(sphere(7.f, 3), voxelScale(), 8.0);
            randomOperations(*piece, sequence);
            const std::string hash = contentHash(*piece->volume);
            if (bits.empty()) {
                bits = hash;
                expectInvariants(*piece->volume, sequence);
            }
            ASSERT_EQ(hash, bits) << "sequence " << sequence << " on " << count << " threads";
        }
    }
}

} // namespace patina::test
