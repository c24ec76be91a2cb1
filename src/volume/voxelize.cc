#include "volume/voxelize.h"

#include "base/errors.h"
#include "volume/inside_signs.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/unsigned_band.h"

#include <fmt/format.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace patina {

namespace {

// The library's own signs take for metal whatever the outside cannot reach, cavities too. So the band is made without
// signs, and gets those of the triangles' winding.
openvdb::FloatGrid::Ptr voxelizeByWinding(const ClosedSurface& surface, const WindingNumber& winding,
                                          const VoxelizeOptions& options, Progress& progress) {
    const double voxelSize = options.scale.voxelSize;
    const auto outer = static_cast<float>(options.exteriorBand * voxelSize);
    const auto inner = static_cast<float>(options.interiorBand * voxelSize);
    const auto widest = static_cast<float>(std::max(options.exteriorBand, options.interiorBand));
    openvdb::FloatGrid::Ptr grid = unsignedBand(surface, voxelSize, widest, progress);
    progress.checkpoint();
    SideGroups(*grid, voxelSize).apply(winding, *grid);
    const auto leaves = leavesOf(grid->tree());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel)
            if (*voxel >= outer || *voxel <= -inner)
                voxel.setValueOff();
    });
    openvdb::tools::pruneInactive(grid->tree());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->tree().root().setBackground(outer, /*updateChildNodes=*/false);
    openvdb::tools::signedFloodFillWithValues(grid->tree(), outer, inner);
    openvdb::tools::pruneLevelSet(grid->tree());
    return grid;
}

} // namespace

LayerVolume voxelize(const ClosedSurface& surface, const VoxelizeOptions& options, Progress& progress) {
    const double voxelSize = options.scale.voxelSize;
    auto grids = std::make_unique<NestGrids>();
    const WindingNumber winding(surface.positions, surface.triangles);
    grids->base = voxelizeByWinding(surface, winding, options, progress);
    grids->space = IndexSpace(grids->base->transform());
    progress.checkpoint();
    grids->interiorBand = options.interiorBand;
    grids->exteriorBand = options.exteriorBand;

    std::atomic<bool> inside{false};
    for (const FloatLeaf* leaf : leavesOf(std::as_const(grids->base->tree())))
        for (auto voxel = leaf->cbeginValueOn(); voxel && !inside; ++voxel)
            if (*voxel < 0.f)
                inside = true;
    if (!inside)
        throw ModelError("model",
                         fmt::format("nothing of it is inside at a voxel size of {:.4g} scene units", voxelSize),
                         "use smaller voxels (--voxels or --voxel-size), or check the model's faces");

    auto tree = std::make_shared<openvdb::Int32Tree>(grids->base->tree(), 0, openvdb::TopologyCopy());
    grids->material = openvdb::Int32Grid::create(tree);
    grids->material->setTransform(grids->base->transform().copy());

    LayerVolume volume(options.scale, options.metal, std::move(grids));
    updateMaterialIds(volume);
    return volume;
}

} // namespace patina
