#pragma once
// What a run will take, before it starts.

#include "script/program.h"
#include "surface/mesh.h"
#include "volume/layer_volume.h"

#include <cstddef>

namespace patina {

struct Budget {
    double activeVoxels = 0.0;
    double allocatedVoxels = 0.0; ///< of all leaves, per grid
    double volumeBytes = 0.0;     ///< of all grids when they are most
    double mapBytes = 0.0;        ///< what baking holds: points of all texels, some rows of all maps
    double residentBytes = 0.0;   ///< what stays from beginning to end: program, model, volume
    double peakBytes = 0.0;       ///< of the process, pictures aside
    double diskBytes = 0.0;       ///< about, uncompressed
};

/// Level sets that a script's volume holds at the most: the base, what is left of the metal, and an interface for every
/// layer. Materials laid on themselves are counted once; what polishing and eroding take away everywhere is not known
/// before and counts on.
int mostLevelSets(const Program& program);

/// From the surface: a band of w voxels around A voxels² of surface holds A w active voxels. The leaves that hold them,
/// and the nodes above those, are counted along lines across the surface.
/// \param wholeTriangles  of a region: those of the whole model, which stays in memory beside it
Budget estimateBudget(const Program& program, const SurfaceMesh& surface, const VolumeScale& scale, int mapResolution,
                      std::size_t wholeTriangles = 0);

} // namespace patina
