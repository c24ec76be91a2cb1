#pragma once
// A small nest of two layers for what reads and writes nests.

#include "operators/coat.h"
#include "support/test_surfaces.h"

namespace patina::test {

/// A ball of 15 voxels under a film of 0.35 and a layer of 1.5 voxels.
inline std::unique_ptr<Piece> coatedBall() {
    auto piece = makePiece(sphere(15.f, 4), voxelScale());
    auto work = piece->work();
    coat(work, "tarnish_1", 0.35, nullptr, piece->progress);
    coat(work, "soot", 1.5, nullptr, piece->progress);
    return piece;
}

} // namespace patina::test
