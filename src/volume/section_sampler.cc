#include "volume/section_sampler.h"

#include "base/errors.h"
#include "volume/nest_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace patina {

struct SectionSampler::Nest {
    const LayerVolume& volume;
    NestSampler sampler;
    double voxelSize;

    double metal(const Imath::V3d& voxels, Imath::V3d& gradient) const {
        const double phi = sampler.valueAndGradient(sampler.reference(), sampler.locate(voxels), gradient) / voxelSize;
        gradient /= voxelSize;
        return phi;
    }

    // Newton steps onto the metal's surface; with `plane` they stay in the plane of that normal.
    bool project(Imath::V3d& point, Imath::V3d& normal, double reach, const Imath::V3d* plane = nullptr) const {
        const Imath::V3d start = point;
        for (int i = 0; i < 40; ++i) {
            Imath::V3d gradient;
            const double phi = metal(point, gradient);
            if (gradient.length2() < 1e-3 || (point - start).length() > reach)
                return false;
            normal = gradient.normalized();
            if (std::abs(phi) < 1e-7)
                return true;
            if (plane)
                gradient -= *plane * plane->dot(gradient);
            const double slope = gradient.length();
            if (slope < 0.05)
                return false;
            point += gradient * (std::clamp(-phi / slope, -0.7, 0.7) / slope);
        }
        return false;
    }
};

SectionSampler::SectionSampler(const LayerVolume& volume)
    : nest_(new Nest{volume, NestSampler(volume.grids()), volume.scale().voxelSize}) {}
SectionSampler::~SectionSampler() = default;
SectionSampler::SectionSampler(SectionSampler&&) noexcept = default;

int SectionSampler::regionAt(const Imath::V3d& point) const {
    const NestCell cell = nest_->sampler.locate(point / nest_->voxelSize);
    for (int k = 0; k < nest_->sampler.interfaceCount(); ++k)
        if (nest_->sampler.value(k, cell) <= 0.0)
            return k;
    return air;
}

std::optional<SectionSampler::Foot> SectionSampler::foot(const Imath::V3d& point, double reach) const {
    Foot foot{point / nest_->voxelSize, {}};
    if (!nest_->project(foot.position, foot.normal, reach))
        return std::nullopt;
    foot.position *= nest_->voxelSize;
    return foot;
}

std::vector<std::optional<SectionSampler::Foot>> SectionSampler::trace(const Imath::V3d& start, const Imath::V3d& along,
                                                                       double step, int count) const {
    const auto middle = foot(start);
    if (!middle)
        throw RunError("section", fmt::format("there is no metal near ({:g}, {:g}, {:g})", start.x, start.y, start.z),
                       "give a point on the model's surface");
    // The plane holds the normal and the direction; where they are parallel, any direction will do.
    Imath::V3d plane = middle->normal.cross(along);
    for (const Imath::V3d& other : {Imath::V3d(1, 0, 0), Imath::V3d(0, 0, 1)})
        if (plane.length() < 1e-6 * std::max(along.length(), 1e-30))
            plane = middle->normal.cross(other);
    plane.normalize();

    const double voxelSize = nest_->voxelSize;
    std::vector<std::optional<Foot>> feet(static_cast<std::size_t>(count));
    const int centre = count / 2;
    feet[centre] = middle;
    // Steps of at most half a voxel between the points asked for.
    const int parts = std::max(1, static_cast<int>(std::ceil(step / voxelSize / 0.5)));
    for (const int side : {1, -1}) {
        Imath::V3d position = middle->position / voxelSize;
        Imath::V3d normal = middle->normal;
        for (int i = centre + side; i >= 0 && i < count; i += side) {
            bool onSurface = true;
            for (int part = 0; part < parts && onSurface; ++part) {
                const Imath::V3d tangent = plane.cross(normal);
                const double length = tangent.length();
                position += tangent * (side * step / voxelSize / parts / std::max(length, 1e-9));
                onSurface = length > 0.05 && nest_->project(position, normal, 1.5, &plane);
            }
            if (!onSurface)
                break;
            feet[i] = Foot{position * voxelSize, normal};
        }
    }
    return feet;
}

SectionSampler::Foot SectionSampler::typicalPlace() const {
    const NestGrids& grids = nest_->volume.grids();
    const auto nest = grids.nest();
    std::vector<std::vector<const FloatLeaf*>> leaves;
    for (const auto* grid : nest)
        leaves.push_back(leavesOf(grid->tree()));
    const std::size_t layers = nest.size() - 1;
    const auto atSurface = [&](float phi) { return std::abs(phi) < 0.5 * nest_->voxelSize; };

    const auto base = leavesOf(std::as_const(grids.base->tree()));

    std::vector<double> mean(layers, 0.0);
    std::size_t voxels = 0;
    for (std::size_t n = 0; n < base.size(); ++n)
        for (auto voxel = base[n]->cbeginValueOn(); voxel; ++voxel)
            if (atSurface(*voxel)) {
                ++voxels;
                for (std::size_t k = 0; k < layers; ++k)
                    mean[k] += double(leaves[k][n]->getValue(voxel.pos())) - leaves[k + 1][n]->getValue(voxel.pos());
            }
    for (double& thickness : mean)
        thickness /= std::max<std::size_t>(1, voxels);

    std::optional<Foot> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < base.size(); ++n)
        for (auto voxel = base[n]->cbeginValueOn(); voxel; ++voxel) {
            if (!atSurface(*voxel))
                continue;
            double difference = 0.0;
            for (std::size_t k = 0; k < layers; ++k)
                if (mean[k] > 0.0)
                    difference += std::abs(
                        (double(leaves[k][n]->getValue(voxel.pos())) - leaves[k + 1][n]->getValue(voxel.pos())) /
                            mean[k] -
                        1.0);
            if (difference >= least)
                continue;
            const openvdb::Coord c = voxel.getCoord();
            if (const auto here = foot(grids.space.position(c) * nest_->voxelSize, 2.0)) {
                best = here;
                least = difference;
            }
        }
    if (!best)
        throw RunError("section", "the volume has no surface");
    return *best;
}

} // namespace patina
