#include "operators/shift_field.h"

#include "volume/band.h"
#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

namespace {

// The closest point of phi_n's zero set to x, in voxels: Newton steps along the gradient bring the point onto the
// surface, a tangential step brings it under x (p is closest where x - p is parallel to the normal).
Imath::V3d closestPoint(const NestSampler& sampler, int top, double voxelSize, const Imath::V3d& x,
                        const Imath::V3d& start) {
    Imath::V3d p = start;
    for (int iteration = 0; iteration < 8; ++iteration) {
        Imath::V3d gradient;
        const double phi = sampler.valueAndGradient(top, sampler.locate(p), gradient) / voxelSize;
        gradient /= voxelSize;
        const double squared = gradient.length2();
        if (squared < 1e-4)
            break;
        const Imath::V3d toSurface = gradient * (-phi / squared);
        const Imath::V3d away = x - p;
        const Imath::V3d tangential = away - gradient * (away.dot(gradient) / squared);
        // Half the tangential step: a whole one overshoots where the surface is curved towards x.
        Imath::V3d step = toSurface + tangential * 0.5;
        const double length = step.length();
        if (length > 1.0)
            step /= length;
        p += step;
        if (length < 1e-4)
            break;
    }
    return p;
}

} // namespace

ShiftField makeShiftField(Workpiece& work, double thicknessUm, const ThicknessMap* map, bool outward,
                          OperationReport& report, Progress& progress) {
    LayerVolume& volume = work.volume;
    const double voxelSize = volume.scale().voxelSize;
    const double drawn = thicknessUm * volume.scale().unitsPerUm(); // scene units
    const double height = stackHeightVoxels(volume);
    if (outward && ensureExteriorBand(volume, height + drawn / voxelSize + 3.0)) {
        work.binding.rebind(volume);
        report.grewBand = true;
    }

    const NestGrids& grids = volume.grids();
    const NestSampler sampler(grids);
    const int top = volume.layerCount();
    const SurfaceBinding& binding = work.binding;
    const SurfaceMesh& surface = binding.surface();
    const auto leaves = leavesOf(std::as_const(grids.base->tree()));
    const std::size_t total = binding.leafStart(leaves.size());
    // Where the stack is a small part of a voxel, the model's closest point is the layer's too.
    const bool thickStack = height > 0.1;
    const bool needDistance = drawn > voxelSize;

    ShiftField field;
    field.thickness.assign(total, 0.f);
    field.slope.assign(total, 1.f);
    if (needDistance)
        field.distance.assign(total, 0.f);
    struct Clamped {
        std::size_t below = 0, above = 0;
    };
    std::vector<Clamped> clamped(leaves.size());

    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        std::size_t at = binding.leafStart(n);
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            SurfacePoint under = binding.at(at);
            const openvdb::Coord c = voxel.getCoord();
            const Imath::V3d x(c.x(), c.y(), c.z());
            Imath::V3d p;
            if (under.triangle >= 0)
                p = positionAt(surface, under) / voxelSize;
            else
                p = x;
            if (thickStack || needDistance) {
                p = closestPoint(sampler, top, voxelSize, x, under.triangle >= 0 ? p : x);
                if (thickStack)
                    under = binding.closest(p * voxelSize);
            }
            if (needDistance) {
                const double phi = sampler.voxel(top, c);
                field.distance[at] = top == 0 ? static_cast<float>(phi)
                                              : static_cast<float>(std::copysign((x - p).length() * voxelSize, phi));
            }
            if (under.triangle < 0)
                continue; // the back of a sheet takes nothing

            Imath::V3d gradient;
            sampler.valueAndGradient(top, sampler.locate(p), gradient);
            field.slope[at] = static_cast<float>(gradient.length() / voxelSize);

            double factor = 1.0;
            if (map) {
                MapPoint point;
                point.position = positionAt(surface, under);
                point.normal = normalAt(surface, under);
                point.triangle = under.triangle;
                point.u = under.u;
                point.v = under.v;
                factor = map->value(point);
                if (factor < 0.0) {
                    factor = 0.0;
                    ++clamped[n].below;
                } else if (!(factor <= 1.0)) {
                    factor = 1.0;
                    ++clamped[n].above;
                }
            }
            field.thickness[at] = static_cast<float>(drawn * factor);
        }
    });
    progress.checkpoint();
    for (const Clamped& c : clamped) {
        report.clampedBelow += c.below;
        report.clampedAbove += c.above;
    }
    return field;
}

} // namespace patina
