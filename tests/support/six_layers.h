#pragma once
// The six layers that time and memory of a whole statue are measured with.

#include "operators/coat.h"
#include "operators/erode.h"
#include "operators/fill.h"
#include "operators/offset.h"
#include "operators/polish.h"

#include "support/test_surfaces.h"

namespace patina::test {

/// Coats, an erosion, a fill, a polish and an offset on a statue of so many voxels along its longest side.
inline void laySixLayers(Piece& piece, int voxels) {
    Workpiece work = piece.work();
    const double longest = piece.volume->scale().voxelSize * voxels;
    const FunctionMap map(
        [&](const MapPoint& point) { return 0.5 + 0.5 * std::sin(point.position.y * 200.0 / longest); });
    coat(work, "tarnish_1", 0.35, nullptr, piece.progress);
    coat(work, "cuprite_2", 1.2, &map, piece.progress);
    coat(work, "marine_patina_3", 3.0, &map, piece.progress);
    coat(work, "marine_patina_4", 1.8, nullptr, piece.progress);
    erode(work, 0.5, &map, {}, piece.progress);
    fill(work, "dirt", 4.0, nullptr, piece.progress);
    polish(work, 5.8, nullptr, piece.progress);
    // A ball of the same size in the world: its layer grows with the resolution as all else does.
    offset(work, "wax", 4.0 / 512.0 * longest, false, piece.progress);
}

} // namespace patina::test
