#pragma once
// The Happy Buddha beside the project as a workpiece, a statue of 20 cm.

#include "support/test_surfaces.h"
#include "surface/limit_surface.h"
#include "surface/mesh_file.h"

#include <filesystem>

namespace patina::test {

/// Null where the file is not there. \param voxels  along the longest side
inline std::unique_ptr<Piece> makeStatue(int voxels, SubdivisionScheme scheme = SubdivisionScheme::none) {
    const std::string file = std::string(PATINA_SOURCE_DIR) + "/../shared/data/meshes/happy_buddha_60k_uv.obj";
    if (!std::filesystem::exists(file))
        return nullptr;
    LimitSurfaceOptions limit;
    limit.scheme = scheme;
    limit.level = scheme == SubdivisionScheme::none ? 0 : 1;
    SurfaceMesh surface = makeLimitSurface(readMesh(file), limit);
    Imath::Box3f box;
    for (const Imath::V3f& p : surface.positions)
        box.extendBy(p);
    const double side = (box.max - box.min)[box.majorAxis()];
    VolumeScale scale;
    scale.voxelSize = side / voxels;
    scale.metresPerUnit = 0.2 / side;
    return makePiece(std::move(surface), scale);
}

} // namespace patina::test
