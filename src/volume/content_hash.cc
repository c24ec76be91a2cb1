#include "base/hash.h"
#include "volume/layer_volume.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

namespace patina {

namespace {

// Leaves are hashed in parallel and their digests hashed in one order, so the result does not depend on the threads.
// By their places, so that it plays no part where in index space the volume lies.
template <typename Tree>
void addTree(ContentHash& hash, const Tree& tree, const IndexSpace& space) {
    auto leaves = leavesOf(tree);
    std::sort(leaves.begin(), leaves.end(), [](const auto* a, const auto* b) { return a->origin() < b->origin(); });
    std::vector<std::uint64_t> digests(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        ContentHash leafHash;
        const auto& leaf = *leaves[i];
        const Imath::V3i place = space.place(leaf.origin());
        leafHash.add(&place, sizeof place);
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            const auto offset = voxel.pos();
            const auto value = *voxel;
            leafHash.add(&offset, sizeof offset);
            leafHash.add(&value, sizeof value);
        }
        digests[i] = leafHash.digest();
    });
    hash.add(digests.data(), digests.size() * sizeof(std::uint64_t));
}

} // namespace

std::string contentHash(const LayerVolume& volume) {
    ContentHash hash;
    const NestGrids& grids = volume.grids();
    for (const std::string& name : volume.palette())
        hash.add(name);
    for (const std::string& name : volume.layers())
        hash.add(name);
    addTree(hash, grids.base->tree(), grids.space);
    if (grids.metal) {
        hash.add("metal");
        addTree(hash, grids.metal->tree(), grids.space);
    }
    for (const auto& interface : grids.interfaces)
        addTree(hash, interface->tree(), grids.space);
    if (grids.material)
        addTree(hash, grids.material->tree(), grids.space);
    for (const auto& [name, field] : grids.fields) {
        hash.add(name);
        addTree(hash, field->tree(), grids.space);
    }
    return hash.text();
}

} // namespace patina
