#pragma once
// Random sequences of all operators, and what must hold of the nest after any of them (DESIGN §1).

#include "base/random.h"
#include "operators/coat.h"
#include "operators/convert.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/grow_layer.h"
#include "operators/material_ratio.h"
#include "operators/offset.h"
#include "operators/offset_tangent_sphere.h"
#include "operators/polish.h"
#include "support/hollow_ball.h"
#include "support/on_threads.h"
#include "support/test_surfaces.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace patina::test {

/// What an operator may do to the nest that it found.
enum class Effect { adds, thickens, converts, removes };

/// What was there is conserved: what is laid on top leaves every bit below it, what is taken away goes from the top,
/// and a conversion moves neither end of the stack.
inline void expectConserved(const LayerVolume& before, const LayerVolume& after, Effect effect, bool metalToo) {
    const auto was = before.grids().nest(), is = after.grids().nest();
    const auto old = [&](std::size_t k) { return was[k]->cbeginValueOn(); };
    const std::size_t kept = effect == Effect::adds ? (is.size() > was.size() ? was.size() : was.size() - 1) : 1;
    for (std::size_t k = 0; k < (metalToo ? 0 : kept); ++k)
        for (auto voxel = old(k); voxel; ++voxel)
            ASSERT_EQ(is[k]->tree().getValue(voxel.getCoord()), *voxel) << "interface " << k << voxel.getCoord();
    for (auto voxel = old(was.size() - 1); voxel; ++voxel) {
        const float now = is.back()->tree().getValue(voxel.getCoord());
        // What lies above a layer that grows keeps its thickness by the slope at its new place, which may be less.
        if (effect == Effect::adds) {
            ASSERT_LE(now, *voxel) << voxel.getCoord();
        } else if (effect == Effect::removes) {
            ASSERT_GE(now, *voxel) << voxel.getCoord();
        } else if (effect == Effect::converts) {
            ASSERT_EQ(now, *voxel) << voxel.getCoord();
        }
    }
    for (auto voxel = before.grids().base->cbeginValueOn(); voxel; ++voxel)
        ASSERT_EQ(after.grids().base->tree().getValue(voxel.getCoord()), *voxel) << "the base never changes";
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

/// A random sequence of operators with random maps, the same for the same number.
/// \param checked  whether the invariants are looked at after each
inline void randomOperations(Piece& piece, int sequence, bool checked = false) {
    const KeyedRandom random(sequence, "operators", "test");
    auto work = piece.work();
    for (int i = 0; i < 7 && !testing::Test::HasFatalFailure(); ++i) {
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
        const bool andMetal = v[3] < 0.3;
        std::optional<LayerVolume> before;
        if (checked)
            before = work.volume.clone();
        Effect effect = Effect::adds;
        std::string what = "coat";
        if (i == 0 || u[0] < 0.35) {
            coat(work, material(v[0]), thickness, map, piece.progress);
        } else if (u[0] < 0.55) {
            what = "erode";
            effect = Effect::removes;
            erode(work, thickness, map, hardness, piece.progress,
                  andMetal ? std::optional<double>(1.0) : std::optional<double>());
        } else if (u[0] < 0.65) {
            what = "fill";
            fill(work, material(v[0]), thickness, map, piece.progress,
                 v[1] < 0.3 ? std::optional<double>(1.0 + 3.0 * v[2]) : std::optional<double>());
        } else if (u[0] < 0.75) {
            what = "polish";
            effect = Effect::removes;
            AreaPolish area;
            area.fraction = v[2];
            area.map = map;
            area.samples = 2048;
            if (v[1] < 0.3)
                polishArea(work, area, piece.progress);
            else
                polish(work, thickness, map, piece.progress);
        } else if (u[0] < 0.83) {
            what = "grow";
            effect = Effect::thickens;
            growLayer(work, material(v[0]), thickness, map, piece.progress);
        } else if (u[0] < 0.91) {
            what = "convert";
            effect = Effect::converts;
            convertLayers(work, material(v[0]), material(v[1]), v[2], map, piece.progress);
        } else if (u[0] < 0.95) {
            what = "tangent spheres";
            offsetTangentSphere(work, material(v[0]), 0.5 + 4.0 * u[2], thickness, v[1] < 0.3, piece.progress);
        } else {
            what = "offset";
            offset(work, material(v[0]), 0.5 + 4.0 * u[2], v[1] < 0.3, piece.progress);
        }
        if (checked) {
            SCOPED_TRACE("sequence " + std::to_string(sequence) + ", step " + std::to_string(i) + ", " + what);
            expectInvariants(work.volume, sequence);
            expectConserved(*before, work.volume, effect, what == "erode" && andMetal);
        }
    }
}

/// A ball, an open sheet or a ball around a closed hollow.
inline std::unique_ptr<Piece> shapeOf(int sequence) {
    switch (sequence % 4) {
    case 1:
        return makePiece(sheet(12.f, 8), voxelScale(), 8.0);
    case 3:
        return hollowBall(9.f, 4.f, 0.0, 8.0, 3);
    default:
        return makePiece(sphere(7.f, 3), voxelScale(), 8.0);
    }
}

/// \param threads  each sequence is run on each of these numbers of threads, with the same bits
inline void runSequences(int first, int last, const std::vector<std::size_t>& threads) {
    for (int sequence = first; sequence < last && !testing::Test::HasFatalFailure(); ++sequence) {
        std::string bits;
        for (const std::size_t count : threads)
            test::onThreads(count, [&] {
                const auto piece = shapeOf(sequence);
                randomOperations(*piece, sequence, bits.empty());
                const std::string hash = contentHash(*piece->volume);
                if (bits.empty())
                    bits = hash;
                ASSERT_EQ(hash, bits) << "sequence " << sequence << " on " << count << " threads";
            });
    }
}

} // namespace patina::test
