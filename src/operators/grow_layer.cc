#include "operators/grow_layer.h"

#include "operators/coat.h"
#include "operators/interface_foot.h"
#include "operators/map_factors.h"
#include "volume/band.h"
#include "volume/distance.h"
#include "volume/leaf_lattice.h"
#include "volume/material_ids.h"
#include "volume/nest_grids.h"
#include "volume/open_air.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace patina {

namespace {

// Where the layer's interface comes to lie under a voxel, and its slope where it lay.
struct NewPlace {
    Imath::V3f foot; ///< voxels
    float slope = 0.f;
};

// What lies above the grown layer k has moved by the same differences of phi. These are thickness times slope, and the
// slope of a trilinear interpolant varies by half a percent along a curved surface: so that films keep their thickness,
// the differences are scaled by the slope at the new place over that at the old one.
void keepFilms(Workpiece& work, const std::vector<std::uint16_t>& lowest, const std::vector<NewPlace>& places) {
    NestGrids& grids = work.volume.grids();
    const double voxelSize = work.volume.scale().voxelSize;
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    std::vector<float> ratio(lowest.size(), 1.f);
    {
        const NestSampler sampler(grids);
        tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
            for (std::size_t at = work.binding.leafStart(n); at < work.binding.leafStart(n + 1); ++at) {
                const int k = lowest[at];
                if (k == 0 || k == static_cast<int>(grids.interfaces.size()))
                    continue;
                const Imath::V3d expected(places[at].foot);
                Imath::V3d p = expected, gradient;
                const double phi = sampler.valueAndGradient(k, sampler.locate(p), gradient);
                p -= gradient * (phi / std::max(gradient.length2(), 1e-6 * voxelSize * voxelSize));
                if ((p - expected).length() > 0.5)
                    continue; // beside an edge of what has grown
                ratio[at] = static_cast<float>(
                    std::clamp(sampler.slope(k, p) / voxelSize / std::max(places[at].slope, 1e-6f), 0.8, 1.25));
            }
        });
    }
    std::vector<std::vector<FloatLeaf*>> leaves;
    for (auto& interface : grids.interfaces)
        leaves.push_back(leavesOf(interface->tree()));
    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        std::size_t at = work.binding.leafStart(n);
        forActive(*base[n], [&](openvdb::Index pos) {
            const std::size_t here = at++;
            if (ratio[here] == 1.f)
                return;
            const double grown = leaves[lowest[here] - 1][n]->buffer().data()[pos];
            for (std::size_t k = lowest[here]; k < leaves.size(); ++k) {
                float& phi = leaves[k][n]->buffer().data()[pos];
                phi = static_cast<float>(grown - (grown - phi) * ratio[here]);
            }
        });
    });
}

} // namespace

OperationReport growLayer(Workpiece& work, const std::string& material, double thicknessUm, const ThicknessMap* map,
                          Progress& progress, bool everywhere) {
    OperationReport report;
    LayerVolume& volume = work.volume;
    std::vector<int> candidates;
    for (int k = 1; k <= volume.layerCount(); ++k)
        if (volume.layers()[k - 1] == material)
            candidates.push_back(k);
    const double thickness = thicknessUm * volume.scale().unitsPerUm();
    if (candidates.empty() && everywhere)
        return coat(work, material, thicknessUm, map, progress);
    if (candidates.empty() || !(thickness > 0.0))
        return report;
    const double voxelSize = volume.scale().voxelSize;
    if (ensureExteriorBand(volume, stackHeightVoxels(volume) + thickness / voxelSize + 3.0)) {
        work.binding.rebind(volume);
        report.grewBand = true;
    }

    // How far each voxel moves, and from which layer on: read from the nest as it is, before anything moves.
    NestGrids& grids = volume.grids();
    const auto base = leavesOf(std::as_const(grids.base->tree()));
    const SurfaceBinding& binding = work.binding;
    const double nanometre = 1e-3 * volume.scale().unitsPerUm();
    std::vector<float> shift(binding.leafStart(base.size()), 0.f);
    std::vector<std::uint16_t> lowest(shift.size(), 0);
    // A move of a twentieth of a voxel sees the same slopes.
    const bool far = thickness > 0.05 * voxelSize && candidates.front() < volume.layerCount();
    std::vector<NewPlace> places(far ? shift.size() : 0);
    std::vector<ClampedFactors> clamped(base.size());
    // Beyond a voxel the distance to the interface takes over, as it does in a coat.
    std::vector<DistanceField> distances;
    if (thickness > voxelSize)
        for (const int k : candidates)
            distances.push_back(distanceToInterface(volume, k, DistanceOptions(), progress));
    {
        const InterfaceFoot feet(work);
        const NestSampler& sampler = feet.sampler();
        tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
            if (progress.cancelled())
                return;
            std::size_t at = binding.leafStart(n);
            for (auto voxel = base[n]->cbeginValueOn(); voxel; ++voxel, ++at)
                for (std::size_t i = 0; i < candidates.size(); ++i) {
                    const int k = candidates[i];
                    const auto foot = feet.find(k, voxel.getCoord(), at);
                    if (foot.under.triangle < 0)
                        continue;
                    const NestCell cell = sampler.locate(foot.position);
                    Imath::V3d gradient;
                    const double phi = sampler.valueAndGradient(k, cell, gradient);
                    const double slope = feet.slope(k, foot.position);
                    // The first of them is remembered: that is where it begins anew if it is in none.
                    const bool isThere = sampler.value(k - 1, cell) - phi > nanometre * slope;
                    if (!isThere && !(everywhere && lowest[at] == 0))
                        continue;
                    const double t =
                        thickness * (map ? clampedFactor(*map, binding.surface(), foot.under, clamped[n]) : 1.0);
                    double moves = slope * t;
                    if (t > voxelSize) {
                        const double byDistance =
                            std::max(0.0, sampler.voxel(k, voxel.getCoord()) - (distances[i].distance[at] - t));
                        moves += std::clamp(t / voxelSize - 1.0, 0.0, 1.0) * (byDistance - moves);
                    }
                    shift[at] = static_cast<float>(moves);
                    lowest[at] = static_cast<std::uint16_t>(k);
                    if (far)
                        places[at] = {Imath::V3f(foot.position + gradient.normalized() * (t / voxelSize)),
                                      static_cast<float>(sampler.slope(k, foot.position) / voxelSize)};
                    if (isThere)
                        break;
                }
        });
    }
    progress.checkpoint();

    std::vector<std::vector<FloatLeaf*>> leaves;
    for (auto& interface : grids.interfaces)
        leaves.push_back(leavesOf(interface->tree()));
    const OpenAir air(volume);
    std::vector<char> changed(base.size(), 0);
    tbb::parallel_for(std::size_t(0), base.size(), [&](std::size_t n) {
        std::size_t at = work.binding.leafStart(n);
        forActive(*base[n], [&](openvdb::Index pos) {
            const std::size_t here = at++;
            if (!(shift[here] > 0.f))
                return;
            changed[n] = 1;
            // Round a pore that is closed the layer grows into those above it: the pore stays as it is.
            const bool sealed = air.isSealed(n, pos);
            const float most =
                sealed ? leaves.back()[n]->buffer().data()[pos] : -std::numeric_limits<float>::infinity();
            for (std::size_t k = lowest[here]; k <= leaves.size(); ++k) {
                float& phi = leaves[k - 1][n]->buffer().data()[pos];
                phi = std::max(phi - shift[here], most);
            }
            if (sealed)
                lowest[here] = 0; // no films to keep
        });
    });
    if (far)
        keepFilms(work, lowest, places);
    for (const ClampedFactors& c : clamped) {
        report.clampedBelow += c.below;
        report.clampedAbove += c.above;
    }
    report.changedIds = updateMaterialIds(volume, 1e-3, report.grewBand ? nullptr : &changed);
    return report;
}

} // namespace patina
