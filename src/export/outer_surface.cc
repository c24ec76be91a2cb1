#include "export/outer_surface.h"

#include "volume/nest_sampler.h"

#include <algorithm>
#include <cmath>

namespace patina {

struct OuterSurface::Nest {
    NestSampler sampler;
    double voxelSize;
    double reach; ///< voxels outside the base where a surface may be
    int base, last;

    double read(int k, const Imath::V3d& point) const { return sampler.value(k, sampler.locate(point)) / voxelSize; }
};

OuterSurface::OuterSurface(const LayerVolume& volume) {
    NestSampler sampler(volume.grids());
    const int base = sampler.reference(), last = volume.layerCount();
    nest_.reset(new Nest{std::move(sampler), volume.scale().voxelSize, volume.grids().exteriorBand + 2.0, base, last});
}

OuterSurface::~OuterSurface() = default;

bool OuterSurface::foldsOver(const Imath::V3d& floor, const Imath::V3d& normal) const {
    const Nest& nest = *nest_;
    if (nest.last == 0)
        return false;
    // Steps of an eighth of a voxel and more: a gap narrower than that is nothing that a lattice of voxels can hold.
    constexpr double shortest = 0.125, longest = 1.0;
    const Imath::V3d origin = floor / nest.voxelSize;
    double away = nest.read(nest.base, origin);
    double phi = nest.read(nest.last, origin);
    bool left = phi > 0.0; // where nothing lies on the metal, whatever comes next hangs over it
    double s = 0.0;
    while (s < nest.reach) {
        const double step = std::clamp(0.9 * std::abs(phi), shortest, longest);
        s += step;
        const NestCell cell = nest.sampler.locate(origin + normal * s);
        const double awayNow = nest.sampler.value(nest.base, cell) / nest.voxelSize;
        if (s > 1.0 && awayNow - away < 0.05 * step)
            return false; // another part of the model is nearer from here on
        away = awayNow;
        phi = nest.sampler.value(nest.last, cell) / nest.voxelSize;
        // A film on bare metal, read half a voxel beside, is no overhang: in again means in by more than rounding.
        if (left && phi < -0.02 && s > 1.0)
            return true;
        left = left || phi > 0.02;
    }
    return false;
}

bool OuterSurface::misses(const Imath::V3d& foot, const Imath::V3d& end) const {
    const Nest& nest = *nest_;
    const double start = std::abs(nest.read(nest.base, foot / nest.voxelSize));
    return std::abs(nest.read(nest.last, end / nest.voxelSize)) > start + 0.1;
}

std::optional<Imath::V3d> OuterSurface::above(const Imath::V3d& floor) const {
    const Nest& nest = *nest_;
    if (nest.last == 0)
        return floor;
    const Imath::V3d start = floor / nest.voxelSize;
    Imath::V3d point = start;
    // Pores hold half a voxel (operators/growth): what is less far outside, and stays so, is not the outside.
    constexpr double poreValue = 0.5, beyond = 0.8;
    const int most = static_cast<int>(nest.reach / 0.05) + 64;
    for (int i = 0; i < most; ++i) {
        const NestCell cell = nest.sampler.locate(point);
        Imath::V3d gradient0, gradient;
        const double phi0 = std::max(0.0, nest.sampler.valueAndGradient(nest.base, cell, gradient0) / nest.voxelSize);
        const double phi = nest.sampler.valueAndGradient(nest.last, cell, gradient) / nest.voxelSize;
        // grad(phi_0 / (phi_0 - phi_n)), but for a positive factor; within a pore straight on from the metal.
        Imath::V3d direction = phi < 0.0 ? gradient0 * -phi + gradient * phi0 : gradient0;
        const double length = direction.length();
        if (!(length > 0.0) || (point - start).length() > 2.0 * nest.reach)
            return std::nullopt;
        direction /= length;
        const double step = std::clamp(0.5 * std::abs(phi), 0.05, 0.25);
        const Imath::V3d next = point + direction * step;
        if (nest.read(nest.last, next) > 0.0 && nest.read(nest.last, next + direction * beyond) > poreValue + 0.05) {
            if (phi > 0.0)
                return point * nest.voxelSize;
            double inside = 0.0, outside = step;
            for (int halving = 0; halving < 40; ++halving) {
                const double middle = 0.5 * (inside + outside);
                (nest.read(nest.last, point + direction * middle) > 0.0 ? outside : inside) = middle;
            }
            return (point + direction * outside) * nest.voxelSize;
        }
        point = next;
    }
    return std::nullopt;
}

} // namespace patina
