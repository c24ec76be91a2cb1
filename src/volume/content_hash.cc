#include "base/hash.h"
#include "volume/layer_volume.h"
#include "volume/nest_grids.h"

#include <tbb/parallel_for.h>

namespace patina {

namespace {

// Leaves are hashed in parallel and their digests hashed in tree order, so the result does not depend on the threads.
template <typename Tree>
void addTree(ContentHash& hash, const Tree& tree) {
    const auto leaves = leavesOf(tree);
    std::vector<std::uint64_t> digests(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        ContentHash leafHash;
        const auto& leaf = *leaves[i];
        leafHash.add(leaf.origin().data(), 3 * sizeof(std::int32_t));
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
    addTree(hash, grids.base->tree());
    if (grids.metal) {
        hash.add("metal");
        addTree(hash, grids.metal->tree());
    }
    for (const auto& interface : grids.interfaces)
        addTree(hash, interface->tree());
    if (grids.material)
        addTree(hash, grids.material->tree());
    for (const auto& [name, field] : grids.fields) {
        hash.add(name);
        addTree(hash, field->tree());
    }
    return hash.text();
}

} // namespace patina
