#pragma once
// The grids inside a LayerVolume, for sources of volume/, operators/ and export/ only: this header pulls OpenVDB in.

#include "volume/layer_volume.h"

#include <openvdb/openvdb.h>

#include <map>
#include <string>
#include <vector>

namespace patina {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using IdLeaf = openvdb::Int32Tree::LeafNodeType;

/// interfaces[k-1] is phi_k. Every grid has the base's active topology, so leaf i of one is leaf i of all.
struct NestGrids {
    openvdb::FloatGrid::Ptr base;
    std::vector<openvdb::FloatGrid::Ptr> interfaces;
    openvdb::Int32Grid::Ptr material;
    std::map<std::string, openvdb::FloatGrid::Ptr> fields;
    double interiorBand = 0.0; ///< voxels inside the base that hold true distances
    double exteriorBand = 0.0; ///< voxels outside the base that hold true distances

    /// phi_0 … phi_n.
    std::vector<const openvdb::FloatGrid*> nest() const;
    const openvdb::FloatGrid& surface() const { return interfaces.empty() ? *base : *interfaces.back(); }
    openvdb::FloatGrid& surface() { return interfaces.empty() ? *base : *interfaces.back(); }
};

/// The leaves of a tree in its own order, which is the same for all trees of one topology.
template <typename Tree>
std::vector<typename Tree::LeafNodeType*> leavesOf(Tree& tree) {
    std::vector<typename Tree::LeafNodeType*> leaves;
    leaves.reserve(tree.leafCount());
    tree.getNodes(leaves);
    return leaves;
}
template <typename Tree>
std::vector<const typename Tree::LeafNodeType*> leavesOf(const Tree& tree) {
    std::vector<const typename Tree::LeafNodeType*> leaves;
    leaves.reserve(tree.leafCount());
    tree.getNodes(leaves);
    return leaves;
}

/// A grid of the same topology and transform with every active voxel at `value`, which is also its background.
openvdb::FloatGrid::Ptr makeGridLike(const openvdb::FloatGrid& grid, float value);

} // namespace patina
