#include "operators/fields/field_grid.h"

#include "base/errors.h"
#include "volume/nest_sampler.h"

#include <fmt/format.h>
#include <openvdb/tools/ChangeBackground.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {

using Imath::V3d;

namespace {

constexpr float unknown = -1.f; // fields are never negative

// The mean of the known among eight corners, by their trilinear weights; unknown where there are none.
float knownAround(const openvdb::FloatGrid::ConstAccessor& accessor, const IndexSpace& space, const V3d& p) {
    const openvdb::Coord low = space.index(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
                                           static_cast<int>(std::floor(p.z)));
    const V3d f = p - space.position(low);
    double sum = 0.0, weights = 0.0;
    for (int c = 0; c < 8; ++c) {
        const int i = c >> 2, j = (c >> 1) & 1, k = c & 1;
        float value;
        if (!accessor.probeValue(low.offsetBy(i, j, k), value) || value < 0.f)
            continue;
        // A little more than nothing, so that a point exactly on a lattice plane has a value as well.
        const double weight = 1e-3 + (i ? f.x : 1.0 - f.x) * (j ? f.y : 1.0 - f.y) * (k ? f.z : 1.0 - f.z);
        sum += weight * value;
        weights += weight;
    }
    return weights > 0.0 ? static_cast<float>(sum / weights) : unknown;
}

struct Place {
    openvdb::Coord coord;
    float value;
};

// Fills what is left from its known neighbours, ring by ring. Each ring reads the one before, so order plays no part.
void fillRings(openvdb::FloatGrid& grid, std::vector<Place> left) {
    while (!left.empty()) {
        const openvdb::FloatGrid& before = grid;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, left.size(), 256), [&](const auto& range) {
            const auto accessor = before.getConstAccessor();
            for (std::size_t n = range.begin(); n != range.end(); ++n) {
                double sum = 0.0;
                int count = 0;
                for (int c = 0; c < 27; ++c) {
                    float value;
                    if (c != 13 &&
                        accessor.probeValue(left[n].coord.offsetBy(c / 9 - 1, c / 3 % 3 - 1, c % 3 - 1), value) &&
                        value >= 0.f) {
                        sum += value;
                        ++count;
                    }
                }
                left[n].value = count > 0 ? static_cast<float>(sum / count) : unknown;
            }
        });
        auto accessor = grid.getAccessor();
        std::vector<Place> still;
        for (const Place& place : left) {
            if (place.value >= 0.f)
                accessor.setValueOnly(place.coord, place.value);
            else
                still.push_back(place);
        }
        if (still.size() == left.size()) { // a part of the band without any surface
            for (const Place& place : still)
                accessor.setValueOnly(place.coord, 0.f);
            return;
        }
        left = std::move(still);
    }
}

class FieldMap : public ThicknessMap {
  public:
    FieldMap(const openvdb::FloatGrid& grid, const IndexSpace& space, double voxelSize) : voxelSize_(voxelSize) {
        grids_.base = grid.deepCopy();
        grids_.space = space;
        sampler_ = std::make_unique<NestSampler>(grids_);
    }
    double value(const MapPoint& point) const override {
        return sampler_->value(0, sampler_->locate(point.position / voxelSize_));
    }

  private:
    NestGrids grids_;
    std::unique_ptr<NestSampler> sampler_;
    double voxelSize_;
};

} // namespace

void storeField(LayerVolume& volume, const std::string& name, int layer, const SurfaceVoxels& surface,
                const std::vector<float>& values) {
    NestGrids& grids = volume.grids();
    const double voxelSize = volume.scale().voxelSize;
    auto seeds = makeGridLike(*grids.base, unknown);
    {
        auto accessor = seeds->getAccessor();
        for (std::size_t i = 0; i < surface.size(); ++i) {
            const Imath::V3i& v = surface.voxels[i];
            accessor.setValueOnly(grids.space.index(v), std::max(0.f, values[i]));
        }
    }
    auto field = seeds->deepCopy();
    openvdb::tools::changeBackground(field->tree(), 0.f);
    const NestSampler sampler(grids);
    const auto leaves = leavesOf(field->tree());
    std::vector<std::vector<Place>> left(leaves.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size()), [&](const auto& range) {
        const auto accessor = std::as_const(*seeds).getConstAccessor();
        for (std::size_t n = range.begin(); n != range.end(); ++n)
            for (auto voxel = leaves[n]->beginValueOn(); voxel; ++voxel) {
                if (*voxel >= 0.f)
                    continue;
                const openvdb::Coord c = voxel.getCoord();
                V3d foot = grids.space.position(c);
                for (int step = 0; step < 2; ++step) { // the second mends what a bent field makes of the first
                    V3d gradient;
                    const double phi = sampler.valueAndGradient(layer, sampler.locate(foot), gradient);
                    if (gradient.length2() > 0.04 * voxelSize * voxelSize)
                        foot -= gradient * (phi / gradient.length2());
                }
                const float value = knownAround(accessor, grids.space, foot);
                voxel.setValue(value);
                if (value < 0.f)
                    left[n].push_back({c, unknown});
            }
    });
    std::vector<Place> all;
    for (const auto& part : left)
        all.insert(all.end(), part.begin(), part.end());
    fillRings(*field, std::move(all));
    grids.fields[name] = field;
}

ThicknessMapPtr makeFieldMap(const LayerVolume& volume, const std::string& name) {
    const auto found = volume.grids().fields.find(name);
    if (found == volume.grids().fields.end())
        throw RunError(name, fmt::format("the volume has no field '{}'", name));
    return std::make_shared<FieldMap>(*found->second, volume.grids().space, volume.scale().voxelSize);
}

} // namespace patina
