#pragma once
// The voxels that the present surface passes by, and the point of the surface under each: where fields are computed.

#include "volume/layer_volume.h"

#include <Imath/ImathVec.h>

#include <vector>

namespace patina {

/// One entry per surface voxel: of every lattice edge that phi_n crosses, the end that is nearer to it. In the order of
/// the band's leaves and voxels.
struct SurfaceVoxels {
    std::vector<Imath::V3i> voxels;     ///< their places (volume/index_space.h)
    std::vector<Imath::V3f> feet;       ///< closest point of the surface, in voxels
    std::vector<Imath::V3f> normals;    ///< outward, unit: the level set's gradient there
    std::vector<std::size_t> leafStart; ///< first entry of each leaf of the band, and the end

    std::size_t size() const { return voxels.size(); }
};

/// \param layer  which interface: volume.layerCount() is the present surface, 0 the bare metal
SurfaceVoxels findSurfaceVoxels(const LayerVolume& volume, int layer);

} // namespace patina
