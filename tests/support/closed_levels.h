#pragma once
// What a closing, as `offset` applies it, makes of each voxel of the outermost metal.

#include "volume/closing.h"
#include "volume/layer_volume.h"
#include "volume/leaf_lattice.h"
#include "volume/nest_grids.h"

#include <Imath/ImathVec.h>

namespace patina::test {

/// The levels of a volume's base before and after a closing (scene units).
class ClosedLevels {
  public:
    ClosedLevels(const LayerVolume& volume, const ClosingOptions& options, Progress& progress) {
        LayerVolume closed = volume.clone();
        const Closing closing = closeInterface(closed, 0, options, progress);
        before_ = closed.grids().base;
        space_ = closed.grids().space;
        after_ = before_->deepCopy();
        std::size_t at = 0;
        for (FloatLeaf* leaf : leavesOf(after_->tree()))
            for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
                voxel.setValue(closing.level[at++]);
    }

    /// By how much the closing lowers a voxel's level; nought where it keeps its bits.
    float filled(const Imath::V3i& voxel) const {
        const openvdb::Coord x = space_.index(voxel);
        return before_->tree().getValue(x) - after_->tree().getValue(x);
    }

  private:
    openvdb::FloatGrid::Ptr before_, after_;
    IndexSpace space_;
};

} // namespace patina::test
