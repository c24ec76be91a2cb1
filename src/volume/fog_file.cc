#include "volume/fog_file.h"

#include "base/atomic_file.h"
#include "base/errors.h"
#include "volume/nest_grids.h"
#include "volume/nest_sampler.h"

#include <fmt/format.h>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace patina {

namespace {

// Along each axis of a voxel, whose cube reaches half way to its neighbours, the field is read at this many places.
constexpr int places = 4;
static_assert(places % 2 == 0, "none in the middle, where the trilinear field has a kink");

// The part of a voxel that lies inside the interface, as it runs between the voxels: the mean over 64 cubes, each of
// which counts as inside by how deep its middle is.
double insideOf(const NestSampler& sampler, int k, const openvdb::Coord& at, double voxelSize) {
    const double middle = sampler.voxel(k, at) / voxelSize;
    // Farther than any corner of the voxel, where the slope is about one.
    if (std::abs(middle) > 1.2)
        return middle < 0.0 ? 1.0 : 0.0;
    // Separably from 3³ values to 4³: first z, then y, then x.
    const auto between = [](int place, double low, double centre, double high) {
        const double offset = (place + 0.5) / places - 0.5;
        return centre + std::abs(offset) * ((offset < 0.0 ? low : high) - centre);
    };
    double alongZ[3][3][places], alongY[3][places][places];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double values[3];
            for (int n = 0; n < 3; ++n)
                values[n] = sampler.voxel(k, at.offsetBy(i - 1, j - 1, n - 1)) / voxelSize;
            for (int z = 0; z < places; ++z)
                alongZ[i][j][z] = between(z, values[0], values[1], values[2]);
        }
    for (int i = 0; i < 3; ++i)
        for (int y = 0; y < places; ++y)
            for (int z = 0; z < places; ++z)
                alongY[i][y][z] = between(y, alongZ[i][0][z], alongZ[i][1][z], alongZ[i][2][z]);
    double sum = 0.0;
    for (int x = 0; x < places; ++x)
        for (int y = 0; y < places; ++y)
            for (int z = 0; z < places; ++z) {
                const double phi = between(x, alongY[0][y][z], alongY[1][y][z], alongY[2][y][z]);
                sum += std::clamp(0.5 - phi * places, 0.0, 1.0);
            }
    return sum / (places * places * places);
}

openvdb::FloatGrid::Ptr fogBetween(const NestGrids& grids, const NestSampler& sampler, int inner, int outer,
                                   double voxelSize, const std::string& name) {
    auto tree = std::make_shared<openvdb::FloatTree>(grids.base->tree(), 0.f, openvdb::TopologyCopy());
    const auto leaves = leavesOf(*tree);
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
        for (openvdb::Index n = 0; n < FloatLeaf::SIZE; ++n) {
            if (!leaves[i]->isValueOn(n))
                continue;
            const openvdb::Coord at = leaves[i]->offsetToGlobalCoord(n);
            const double outside = insideOf(sampler, outer, at, voxelSize);
            const double part = outside > 0.0 ? outside - insideOf(sampler, inner, at, voxelSize) : 0.0;
            if (part > 0.0)
                leaves[i]->setValueOnly(n, static_cast<float>(part));
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
    const NestSampler sampler(grids);
    const double voxelSize = volume.scale().voxelSize;
    openvdb::GridPtrVec out;
    out.push_back(fogBetween(grids, sampler, 0, volume.layerCount(), voxelSize, "density"));
    for (int k = 1; k <= volume.layerCount(); ++k)
        out.push_back(fogBetween(grids, sampler, k - 1, k, voxelSize,
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
