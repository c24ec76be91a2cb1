#include "operators/fields/exposure.h"

#include "base/errors.h"
#include "operators/fields/plane_fit.h"
#include "operators/fields/voxel_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

using Imath::V3d;
using Imath::V3f;

DomeGatherer::DomeGatherer(const LightDome& dome, const Compass& compass, const DomeGathering& options)
    : up_(compass.up), rays_(options.rays), ground_(options.ground),
      groundHeight_(static_cast<float>(options.groundHeight)) {
    if (rays_ < 1 || rays_ > 65536)
        throw RunError("exposure", "the number of rays is out of range", "use 1 to 65536");
    LightDome all;
    all.add(dome, 1.0);
    if (ground_) {
        const double level = dome.irradiance({0.0, 0.0, 1.0});
        // Lambert: the unshadowed ground looks the same from everywhere.
        all.addHemisphere([](const V3d&) { return 1.0; }, options.groundAlbedo * level, false);
        const double total = dome.total();
        for (const V3d& d : dome.directions(rays_, sets)) {
            upper_.emplace_back(compass.direction(d));
            upperWeight_.push_back(static_cast<float>(std::max(0.0, d.z) * total / level));
        }
    }
    for (const V3d& d : all.directions(rays_, sets))
        directions_.emplace_back(compass.direction(d));
    scale_ = static_cast<float>(all.total() / (rays_ * all.largestIrradiance()));
}

double DomeGatherer::irradiance(const V3f& position, const V3f& normal, int set, const Occlusion& occluded) const {
    const V3f* directions = directions_.data() + std::size_t(set) * rays_;
    double sum = 0.0;
    // Looks back from the ground are taken in the order of another set, whatever the directions that led there: index
    // by index, the two would not be independent.
    std::size_t back = std::size_t((set + 29) % sets) * rays_;
    for (int i = 0; i < rays_; ++i) {
        const float cosine = directions[i].dot(normal);
        if (cosine <= 0.f || occluded(position, directions[i]))
            continue;
        const float rise = directions[i].dot(up_);
        if (!ground_ || rise >= 0.f) {
            sum += cosine;
            continue;
        }
        // What the ground sends from there: one look from it back into the dome.
        const float height = std::max(0.f, position.dot(up_) - groundHeight_);
        const V3f place = position + directions[i] * (height / -rise);
        if (!occluded(place, upper_[back]))
            sum += cosine * upperWeight_[back];
        ++back;
    }
    return std::clamp(sum * scale_, 0.0, 1.0);
}

namespace {

// The value at each voxel of a plane through its own and those of its 26 neighbours that face the same way: they have
// other sets of directions, so the grain of one set goes, while shadows only get as soft as the voxels are.
std::vector<float> withoutGrain(const SurfaceVoxels& surface, const OpenPlaces& places,
                                const std::vector<float>& values) {
    const VoxelTable table(surface.voxels);
    std::vector<float> smooth(values.size());
    tbb::parallel_for(std::size_t(0), values.size(), [&](std::size_t i) {
        const V3f& normal = places.normals[i];
        PlaneFit fit(normal);
        fit.add(2.0, V3f(0.f), values[i]);
        for (int c = 0; c < 27; ++c) {
            const int j =
                c == 13 ? -1 : table.find(surface.voxels[i] + Imath::V3i(c / 9 - 1, c / 3 % 3 - 1, c % 3 - 1));
            if (j < 0)
                continue;
            const double alike = (normal.dot(places.normals[j]) - 0.9) / 0.1;
            if (alike > 0.0)
                fit.add(alike, surface.feet[j] - surface.feet[i], values[j]);
        }
        smooth[i] = fit.atPoint();
    });
    return smooth;
}

} // namespace

std::vector<float> gatherDome(const SurfaceVoxels& surface, double voxelSize, const LightDome& dome,
                              const Compass& compass, const Obstacles& obstacles, const DomeGathering& options,
                              Progress& progress) {
    const DomeGatherer gatherer(dome, compass, options);
    const OpenPlaces places = openPlaces(surface, voxelSize, obstacles);
    std::vector<float> values(surface.size());
    const auto size = static_cast<float>(voxelSize);
    // In slices, so that the one thread that reports does so between them.
    constexpr std::size_t slices = 50;
    for (std::size_t slice = 0; slice < slices; ++slice) {
        const std::size_t begin = surface.size() * slice / slices, end = surface.size() * (slice + 1) / slices;
        tbb::parallel_for(begin, end, [&](std::size_t i) {
            if (progress.cancelled())
                return;
            // Every set once in 4³ voxels; 37 is odd, so neighbours get blocks that are far apart in the sequence.
            const Imath::V3i& v = surface.voxels[i];
            const int set = (((v.x & 3) << 4 | (v.y & 3) << 2 | (v.z & 3)) * 37) & (DomeGatherer::sets - 1);
            values[i] = static_cast<float>(
                gatherer.irradiance(places.points[i] * size, places.normals[i], set, obstacles.occluded));
        });
        progress.checkpoint();
        progress.update(double(slice + 1) / slices);
    }
    return withoutGrain(surface, places, values);
}

} // namespace patina
