#pragma once
// The grids inside a LayerVolume, for sources of volume/, operators/ and export/ only: this header pulls OpenVDB in.

#include "volume/grid_instances.h"
#include "volume/index_space.h"
#include "volume/layer_volume.h"

#include <map>
#include <string>
#include <vector>

namespace patina {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using IdLeaf = openvdb::Int32Tree::LeafNodeType;

/// interfaces[k-1] is phi_k. Every grid has the base's active topology, so leaf i of one is leaf i of all.
/// The floor is what the layers lie on: `metal` where the metal itself was eroded, `base` otherwise.
struct NestGrids {
    openvdb::FloatGrid::Ptr base;  ///< phi_0: the metal as it was; heights are measured from it
    openvdb::FloatGrid::Ptr metal; ///< phi_m >= phi_0: what is left of the metal; null until `erode … and metal`
    std::vector<openvdb::FloatGrid::Ptr> interfaces;
    openvdb::Int32Grid::Ptr material;
    std::map<std::string, openvdb::FloatGrid::Ptr> fields;
    IndexSpace space; ///< of all the grids
    /// Of a region: the voxels (indices) among which the band was made and where it is cut off; empty for a whole model. What lies
    /// beyond is no air: nothing is read there, and the band does not grow there.
    openvdb::CoordBBox sides;
    double interiorBand = 0.0; ///< voxels inside the base that hold true distances
    double exteriorBand = 0.0; ///< voxels outside the base that hold true distances

    const openvdb::FloatGrid& floor() const { return metal ? *metal : *base; }
    openvdb::FloatGrid& floor() { return metal ? *metal : *base; }

    /// The floor and phi_1 … phi_n: region k lies between the k-th and the one before it.
    std::vector<const openvdb::FloatGrid*> nest() const;
    const openvdb::FloatGrid& surface() const { return interfaces.empty() ? floor() : *interfaces.back(); }
    openvdb::FloatGrid& surface() { return interfaces.empty() ? floor() : *interfaces.back(); }
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
