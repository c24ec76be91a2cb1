#pragma once
// A volume with its grids elsewhere in index space: nothing that is computed may depend on that.

#include "support/test_surfaces.h"
#include "volume/nest_grids.h"

#include <memory>
#include <vector>

namespace patina::test {

/// \param by  multiples of 8
template <typename Tree>
std::shared_ptr<Tree> movedTree(const Tree& tree, const openvdb::Coord& by) {
    const auto moved = std::make_shared<Tree>(tree.background());
    for (auto tile = tree.cbeginValueAll(); tile; ++tile)
        if (tile.getDepth() < 3 && *tile != tree.background()) {
            openvdb::CoordBBox box = tile.getBoundingBox();
            box.translate(by);
            moved->fill(box, *tile, tile.isValueOn());
        }
    for (const auto* leaf : leavesOf(tree)) {
        auto copy = std::make_unique<typename Tree::LeafNodeType>(*leaf);
        copy->setOrigin(leaf->origin() + by);
        moved->addLeaf(copy.release());
    }
    return moved;
}

/// Puts the model's origin at another index; of a whole model's volume.
inline void moveTo(LayerVolume& volume, const openvdb::Coord& origin) {
    NestGrids& grids = volume.grids();
    const openvdb::Coord by = origin - grids.space.origin();
    grids.space = IndexSpace(origin);
    const auto move = [&](auto& grid) {
        grid.setTree(movedTree(grid.tree(), by));
        grid.setTransform(grids.space.transform(volume.scale().voxelSize));
    };
    move(*grids.base);
    if (grids.metal)
        move(*grids.metal);
    for (auto& interface : grids.interfaces)
        move(*interface);
    move(*grids.material);
    for (auto& field : grids.fields)
        move(*field.second);
}

inline void moveTo(Piece& piece, const openvdb::Coord& origin) {
    moveTo(*piece.volume, origin);
    piece.binding = std::make_unique<SurfaceBinding>(*piece.volume, piece.surface, piece.closed);
}

} // namespace patina::test
