#pragma once
// The loops of LookTable over the lanes of a batch.

#include "optics/bsdf_batch.h"

#include <cstddef>

namespace patina {

struct LookLanes {
    std::size_t count;
    const int* from; ///< of each lane: which of the hits
    const int* triangle;
    const float *u, *v;
    const int* triangles; ///< of the mesh, three corners each
    const float* values;  ///< of the table
    int stride;           ///< of a vertex
    float *diffuseX, *diffuseY, *diffuseZ;
    float *meanAir, *leastAir;
};
/// The diffuse part; no air yet.
void mixDiffuseLanes(const LookLanes& lanes);

struct LobeLanes {
    LookLanes lanes;
    int place; ///< of the lobe in a vertex's values
    LobeShape shape;
    BsdfBatch::LobeRows to;
};
/// One lobe, and what it adds to the air's.
void mixLobeLanes(const LobeLanes& lanes);

} // namespace patina
