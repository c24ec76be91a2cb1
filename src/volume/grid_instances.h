#pragma once
// The trees of our grids, instantiated once: without this every source that touches a grid compiles OpenVDB's trees anew,
// half of its time. (Leaves and roots have members that do not compile for every type; they stay implicit.)

#include <openvdb/openvdb.h>
#include <openvdb/tree/LeafManager.h>

#define PATINA_GRID_INSTANCES(prefix, tree_)                                                                            \
    prefix template class openvdb::tree::InternalNode<openvdb::tree_::LeafNodeType, 4>;                                \
    prefix template class openvdb::tree::InternalNode<openvdb::tree::InternalNode<openvdb::tree_::LeafNodeType, 4>, 5>; \
    prefix template class openvdb::tree::Tree<openvdb::tree_::RootNodeType>;                                           \
    prefix template class openvdb::Grid<openvdb::tree_>;                                                               \
    prefix template class openvdb::tree::LeafManager<openvdb::tree_>

PATINA_GRID_INSTANCES(extern, FloatTree);
PATINA_GRID_INSTANCES(extern, Int32Tree);
