#include "operators/fields/exposure.h"

#include "base/errors.h"
#include "operators/fields/voxel_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

// A plane through the values of a voxel and of its 26 neighbours that face the same way, read at the voxel itself: they
// have other sets of directions, so the grain of one set goes, while shadows only get as soft as the voxels are. A mean
// would do in the middle of a wall; beside its edge all neighbours lie on one side, and it would be their value.
class PlaneFit {
  public:
    void add(double weight, const V3f& away, const V3f& s, const V3f& t, float value) {
        const double x = away.dot(s), y = away.dot(t);
        w_ += weight;
        x_ += weight * x, y_ += weight * y, v_ += weight * value;
        xx_ += weight * x * x, xy_ += weight * x * y, yy_ += weight * y * y;
        xv_ += weight * x * value, yv_ += weight * y * value;
        least_ = std::min(least_, value);
        most_ = std::max(most_, value);
    }

    float atOrigin() const {
        const double x = x_ / w_, y = y_ / w_, v = v_ / w_;
        constexpr double stiffness = 0.02; // voxels²: few neighbours in a line make no plane
        const double xx = xx_ / w_ - x * x + stiffness, yy = yy_ / w_ - y * y + stiffness, xy = xy_ / w_ - x * y;
        const double xv = xv_ / w_ - x * v, yv = yv_ / w_ - y * v;
        const double determinant = xx * yy - xy * xy;
        const double slopeX = (yy * xv - xy * yv) / determinant, slopeY = (xx * yv - xy * xv) / determinant;
        return std::clamp(static_cast<float>(v - slopeX * x - slopeY * y), least_, most_);
    }

  private:
    double w_ = 0.0, x_ = 0.0, y_ = 0.0, v_ = 0.0, xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, xv_ = 0.0, yv_ = 0.0;
    float least_ = std::numeric_limits<float>::max(), most_ = std::numeric_limits<float>::lowest();
};

std::vector<float> withoutGrain(const SurfaceVoxels& surface, const std::vector<float>& values) {
    const VoxelTable table(surface.voxels);
    std::vector<float> smooth(values.size());
    tbb::parallel_for(std::size_t(0), values.size(), [&](std::size_t i) {
        const V3f& normal = surface.normals[i];
        const V3f s = normal.cross(std::abs(normal.x) < 0.6f ? V3f(1, 0, 0) : V3f(0, 1, 0)).normalized();
        const V3f t = normal.cross(s);
        PlaneFit fit;
        fit.add(2.0, V3f(0.f), s, t, values[i]);
        for (int c = 0; c < 27; ++c) {
            const int j =
                c == 13 ? -1 : table.find(surface.voxels[i] + Imath::V3i(c / 9 - 1, c / 3 % 3 - 1, c % 3 - 1));
            if (j < 0)
                continue;
            const double alike = (normal.dot(surface.normals[j]) - 0.9) / 0.1;
            if (alike > 0.0)
                fit.add(alike, surface.feet[j] - surface.feet[i], s, t, values[j]);
        }
        smooth[i] = fit.atOrigin();
    });
    return smooth;
}

// Voxels: from where the triangles are looked for, how deep below that, and how far above them rays leave.
constexpr float searchFrom = 0.3f, searchDepth = 1.3f, clearance = 0.01f;

V3f startOver(const V3f& foot, const V3f& normal, float voxelSize, const Obstacles& obstacles) {
    const V3f above = foot + normal * (searchFrom * voxelSize);
    const std::optional<float> depth = obstacles.first(above, -normal, searchDepth * voxelSize);
    return depth ? above - normal * (*depth - clearance * voxelSize) : above;
}

} // namespace

Obstacles Obstacles::of(const RayScene& scene) {
    return {[&scene](const V3f& o, const V3f& d) {
                return scene.occluded(o, d, 0.f, std::numeric_limits<float>::infinity());
            },
            [&scene](const V3f& o, const V3f& d, float farthest) -> std::optional<float> {
                const auto hit = scene.intersect(o, d, 0.f, farthest);
                return hit ? std::optional<float>(hit->distance) : std::nullopt;
            }};
}

std::vector<float> gatherDome(const SurfaceVoxels& surface, double voxelSize, const LightDome& dome,
                              const Compass& compass, const Obstacles& obstacles, const DomeGathering& options,
                              Progress& progress) {
    const DomeGatherer gatherer(dome, compass, options);
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
            const V3f position = startOver(surface.feet[i] * size, surface.normals[i], size, obstacles);
            values[i] = static_cast<float>(gatherer.irradiance(position, surface.normals[i], set, obstacles.occluded));
        });
        progress.checkpoint();
        progress.update(double(slice + 1) / slices);
    }
    return withoutGrain(surface, values);
}

} // namespace patina
