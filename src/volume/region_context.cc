#include "volume/region_context.h"

#include "base/errors.h"
#include "volume/grid_instances.h"
#include "volume/index_space.h"
#include "volume/vdb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {

struct ContextFields::Grids {
    std::vector<openvdb::FloatGrid::Ptr> fields;
};

ContextFields::ContextFields(const std::filesystem::path& path, const Imath::Box3d& box, double metresPerUnit)
    : grids_(std::make_unique<Grids>()) {
    const std::string file = path.string();
    checkVolumeFile(path);
    try {
        openvdb::io::File vdb(file);
        vdb.open(/*delayLoad=*/false);
        const auto metres = vdb.getMetadata()->getMetadata<openvdb::DoubleMetadata>("patina_metres_per_unit");
        if (!metres || std::abs(metres->value() / metresPerUnit - 1.0) > 1e-9)
            throw RunError(file, "is of a model in another unit", "give the same --unit as for the whole model");
        const auto all = vdb.readAllGridMetadata();
        for (const auto& head : *all) {
            if (!head->isType<openvdb::FloatGrid>() || head->getGridClass() != openvdb::GRID_UNKNOWN)
                continue;
            const double more = 4.0 * head->voxelSize()[0];
            const openvdb::BBoxd world(openvdb::Vec3d(box.min.x - more, box.min.y - more, box.min.z - more),
                                       openvdb::Vec3d(box.max.x + more, box.max.y + more, box.max.z + more));
            grids_->fields.push_back(openvdb::gridPtrCast<openvdb::FloatGrid>(vdb.readGrid(head->getName(), world)));
            names_.push_back(head->getName());
        }
        vdb.close();
    } catch (const openvdb::Exception& failure) {
        throw RunError(file, fmt::format("cannot be read as a volume: {}", failure.what()), "is it a whole .vdb file?");
    }
}

ContextFields::~ContextFields() = default;
ContextFields::ContextFields(ContextFields&&) noexcept = default;

int ContextFields::find(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? -1 : static_cast<int>(found - names_.begin());
}

double ContextFields::value(int field, const Imath::V3d& position) const {
    const openvdb::FloatGrid& grid = *grids_->fields[field];
    const IndexSpace space(grid.transform());
    const Imath::V3d at = position * (1.0 / grid.voxelSize()[0]);
    const openvdb::Coord corner = space.index(static_cast<int>(std::floor(at.x)), static_cast<int>(std::floor(at.y)),
                                              static_cast<int>(std::floor(at.z)));
    const openvdb::FloatTree& tree = grid.tree();
    float value = 0.f;
    double sum = 0.0, weights = 0.0;
    for (int c = 0; c < 8; ++c) {
        const openvdb::Coord voxel = corner.offsetBy(c & 1, (c >> 1) & 1, c >> 2);
        const Imath::V3d away = at - space.position(voxel);
        const double weight = (1.0 - std::abs(away.x)) * (1.0 - std::abs(away.y)) * (1.0 - std::abs(away.z));
        if (weight > 0.0 && tree.probeValue(voxel, value)) {
            sum += weight * value;
            weights += weight;
        }
    }
    if (weights > 1e-6)
        return sum / weights;
    double nearest = 9.0, found = 0.0;
    for (int i = -1; i <= 2; ++i)
        for (int j = -1; j <= 2; ++j)
            for (int k = -1; k <= 2; ++k) {
                const openvdb::Coord voxel = corner.offsetBy(i, j, k);
                const double away = (space.position(voxel) - at).length2();
                if (away < nearest && tree.probeValue(voxel, value)) {
                    nearest = away;
                    found = value;
                }
            }
    return found;
}

} // namespace patina
