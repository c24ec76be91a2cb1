#include "volume/fog_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "volume/nest_grids.h"

#include <fmt/format.h>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <vector>

namespace patina {

namespace {

// The part of a voxel that lies inside, where the interface is flat.
float insideOf(float phi, float voxelSize) {
    return std::clamp(0.5f - phi / voxelSize, 0.f, 1.f);
}

openvdb::FloatGrid::Ptr fogBetween(const NestGrids& grids, const openvdb::FloatGrid& inner,
                                   const openvdb::FloatGrid& outer, float voxelSize, const std::string& name) {
    auto tree = std::make_shared<openvdb::FloatTree>(grids.base->tree(), 0.f, openvdb::TopologyCopy());
    const auto leaves = leavesOf(*tree);
    const auto innerLeaves = leavesOf(inner.tree()), outerLeaves = leavesOf(outer.tree());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        for (openvdb::Index n = 0; n < FloatLeaf::SIZE; ++n) {
            if (!leaves[i]->isValueOn(n))
                continue;
            const float part =
                insideOf(outerLeaves[i]->getValue(n), voxelSize) - insideOf(innerLeaves[i]->getValue(n), voxelSize);
            if (part > 0.f)
                leaves[i]->setValueOnly(n, part);
            else
                leaves[i]->setValueOff(n, 0.f);
        }
    });
    openvdb::tools::pruneInactive(*tree);
    auto grid = openvdb::FloatGrid::create(tree);
    grid->setTransform(grids.base->transform().copy());
    grid->setName(name);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setCreator("vdb-patina");
    return grid;
}

} // namespace

void writeFog(const LayerVolume& volume, const std::filesystem::path& path, bool half) {
    if (volume.layerCount() == 0)
        throw RunError(path.string(), "the volume has no layers that could be a fog");
    const NestGrids& grids = volume.grids();
    const auto nest = grids.nest();
    const auto voxelSize = static_cast<float>(volume.scale().voxelSize);
    openvdb::GridPtrVec out;
    out.push_back(fogBetween(grids, *nest.front(), *nest.back(), voxelSize, "density"));
    for (int k = 1; k <= volume.layerCount(); ++k)
        out.push_back(fogBetween(grids, *nest[k - 1], *nest[k], voxelSize,
                                 fmt::format("density_{:02d}_{}", k, volume.layers()[k - 1])));
    for (const auto& grid : out)
        grid->setSaveFloatAsHalf(half);
    openvdb::MetaMap meta;
    meta.insertMeta("creator", openvdb::StringMetadata("vdb-patina " + volume.provenance.program));
    meta.insertMeta("patina_version", openvdb::StringMetadata(volume.provenance.program));
    meta.insertMeta("patina_script_name", openvdb::StringMetadata(volume.provenance.scriptName));
    meta.insertMeta("patina_exaggeration", openvdb::DoubleMetadata(volume.scale().exaggeration));
    AtomicFile file(path);
    try {
        openvdb::io::File vdb(file.temporary().string());
        vdb.write(out, meta);
        vdb.close();
    } catch (const openvdb::Exception& failure) {
        throw RunError(path.string(), fmt::format("cannot write the volume: {}", failure.what()), "is the disk full?");
    }
    file.commit();
}

} // namespace patina
