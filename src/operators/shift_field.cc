#include "operators/shift_field.h"

#include "operators/interface_foot.h"
#include "operators/map_factors.h"
#include "volume/band.h"
#include "volume/distance.h"
#include "volume/nest_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace patina {

ShiftField makeShiftField(Workpiece& work, double thicknessUm, const ThicknessMap* map, bool outward,
                          OperationReport& report, Progress& progress, ShiftReach reach) {
    LayerVolume& volume = work.volume;
    const double voxelSize = volume.scale().voxelSize;
    const double drawn = thicknessUm * volume.scale().unitsPerUm(); // scene units
    if (outward && ensureBandAbove(volume, drawn / voxelSize + 3.0)) {
        work.binding.rebind(volume);
        report.grewBand = true;
    }

    const NestGrids& grids = volume.grids();
    const int top = volume.layerCount();
    const SurfaceBinding& binding = work.binding;
    const SurfaceMesh& surface = binding.surface();
    const auto leaves = leavesOf(std::as_const(grids.base->tree()));
    const std::size_t total = binding.leafStart(leaves.size());
    // Where the stack is a small part of a voxel, the model's closest point is the layer's too, and so is its slope: 1.
    const bool thickStack = !isThinStack(volume);
    const bool everywhere = !map && !binding.hasBack();
    const bool needDistance = drawn * reach.most > voxelSize;
    const bool needSlope =
        thickStack &&
        !(everywhere && drawn * reach.least >= 2.0 * voxelSize); // from there on the distance alone counts
    const bool needFeet = thickStack && (needSlope || !everywhere);

    // D(phi_0) is phi_0 itself: recomputed from its crossings it would lose the model's edges.
    const bool bare = top == 0 && !grids.metal;
    DistanceField transform;
    if (needFeet || (needDistance && !bare)) {
        DistanceOptions options;
        options.feet = needFeet;
        transform = distanceToInterface(volume, top, options, progress);
    }

    ShiftField field;
    field.thickness.assign(total, everywhere ? static_cast<float>(drawn) : 0.f);
    field.slope.assign(total, 1.f);
    if (needDistance && !bare)
        field.distance = std::move(transform.distance);
    else if (needDistance)
        field.distance.assign(total, 0.f);
    const bool copyDistance = needDistance && bare;
    progress.checkpoint();
    if (!copyDistance && !needSlope && everywhere)
        return field;

    const NestSampler sampler(grids);
    const auto topLeaves = leavesOf(std::as_const(grids.surface().tree()));
    std::vector<ClampedFactors> clamped(leaves.size());
    tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t n) {
        if (progress.cancelled())
            return;
        std::size_t at = binding.leafStart(n);
        for (auto voxel = leaves[n]->cbeginValueOn(); voxel; ++voxel, ++at) {
            if (copyDistance)
                field.distance[at] = topLeaves[n]->buffer().data()[voxel.pos()];
            if (!needSlope && everywhere)
                continue;
            SurfacePoint under = binding.at(at);
            const openvdb::Coord c = voxel.getCoord();
            Imath::V3d p = sampler.position(c);
            if (needFeet)
                p += Imath::V3d(transform.toFoot[at]);
            else if (under.triangle >= 0)
                p = positionAt(surface, under) / voxelSize;
            const NestCell cell = sampler.locate(p);
            if (needFeet && !everywhere) {
                // The base is about |phi_0(p)| away: a search that knows is short.
                const double away = std::abs(sampler.value(sampler.reference(), cell));
                under = binding.closest(p * voxelSize, static_cast<float>(1.02 * away + 0.25 * voxelSize));
            }
            if (under.triangle < 0) {
                field.thickness[at] = 0.f; // the back of a sheet takes nothing
                continue;
            }
            if (needSlope)
                field.slope[at] = static_cast<float>(sampler.slope(top, p) / voxelSize);
            const double factor = map ? clampedFactor(*map, surface, under, clamped[n]) : 1.0;
            field.thickness[at] = static_cast<float>(drawn * factor);
        }
    });
    progress.checkpoint();
    for (const ClampedFactors& c : clamped) {
        report.clampedBelow += c.below;
        report.clampedAbove += c.above;
    }
    return field;
}

} // namespace patina
